#include "bench/job/ranks.hpp"

#include <cstdlib>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include "bench/job/notes.hpp"
#include "bench/process/clock.hpp"
#include "bench/process/messages.hpp"

namespace polhode::bench {
namespace {

std::optional<int> number_in_environment(char const* name) {
  char const* text = std::getenv(name);
  return text && *text ? std::optional(std::atoi(text)) : std::nullopt;
}
std::optional<int> first_of(std::initializer_list<char const*> names) {
  for (char const* name : names)
    if (auto const number = number_in_environment(name)) return number;
  return {};
}

/// What mpirun of Open MPI and of MPICH, and srun with a PMI, tell the processes they start.
std::optional<int> rank_by_launcher() {
  return first_of({"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"});
}
int size_by_launcher() {
  return first_of({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_NTASKS"}).value_or(1);
}

}  // namespace

Ranks Ranks::of_this_job() {
  if (!launched()) return Ranks(nullptr);
  auto channel = mpi_channel();
  if (!channel && size_by_launcher() > 1) {
    if (!speaks_for_the_job()) throw EndedElsewhere();
    throw UsageError(
        "several ranks, but this polhode was built without MPI: build with -DPOLHODE_MPI=ON, or use `run --shard K/N`");
  }
  return Ranks(std::move(channel));
}

bool launched() {
  return rank_by_launcher().has_value();
}

bool speaks_for_the_job() {
  return rank_by_launcher().value_or(0) == 0;
}

Ranks::Ranks(std::unique_ptr<Channel> channel) : channel_(std::move(channel)), unwinding_(std::uncaught_exceptions()) {}

Ranks::~Ranks() {  // NOLINT(bugprone-exception-escape): who cannot take leave ends, and the launcher the others
  if (!channel_) return;
  bool const unwinding = std::uncaught_exceptions() > unwinding_;
  if (unwinding && !ended_together_ && !alone()) return;  // the others do not know: the launcher ends them
  // Who waits for the others here sleeps; in MPI_Finalize it would take a processor from who still works.
  if (!ended_together_) together([] {});
  channel_->leave();
}

void Ranks::together(std::function<void()> const& step) {
  if (alone()) return step();
  std::exception_ptr failure;
  try {
    step();
  } catch (...) {
    failure = std::current_exception();
  }
  if (!manager()) {
    send(*channel_, 0, failure ? note_of(failure) : Note{Word::arrived});
    word_of_manager();
    return;
  }
  // Of several failures the one of the lowest rank is told: the manager's own, where all have it.
  std::map<int, std::exception_ptr> failures;
  for (int heard = 1; heard < size(); ++heard) {
    Heard const worker = await(*channel_);
    if (worker.note.word == Word::failed) failures.emplace(worker.from, failure_of(worker));
  }
  if (!failure && !failures.empty()) failure = failures.begin()->second;
  end_for_all(failure);
}

std::string Ranks::from_manager(std::function<std::string()> const& make) {
  if (alone()) return make();
  if (!manager()) return word_of_manager();
  std::string bytes;
  try {
    bytes = make();
  } catch (...) {
    end_for_all(std::current_exception());
  }
  send_all(*channel_, {Word::bytes, 0, bytes});
  return bytes;
}

void Ranks::distribute(std::int64_t count, Work const& work, Deliver const& deliver, std::atomic<bool>* stop) {
  std::atomic<bool> nobody_asks = false;
  std::atomic<bool>& stopping = stop ? *stop : nobody_asks;
  if (alone()) {
    for (std::int64_t k = 0; k < count && !stopping; ++k) {
      std::string bytes = work(k);
      if (!stopping) deliver(k, std::move(bytes));
    }
    return;
  }
  double const start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  std::exception_ptr failure;
  bool goes_on = true;
  if (manager())
    failure = deal_out(*channel_, count, work, deliver, stopping);
  else
    goes_on = serve(*channel_, work, stopping);
  cpu_time_ += seconds_of(CLOCK_THREAD_CPUTIME_ID) - start;
  if (manager()) return end_for_all(failure);
  if (!goes_on) leave_quietly();
}

Traffic Ranks::traffic() const {
  Traffic traffic = channel_ ? channel_->traffic() : Traffic{};
  traffic.cpu_time = cpu_time_;
  return traffic;
}

std::string Ranks::word_of_manager() {
  Heard const heard = await(*channel_);
  if (heard.note.word == Word::failed) leave_quietly();
  return heard.note.text;
}

void Ranks::leave_quietly() {
  ended_together_ = true;
  throw EndedElsewhere();
}

void Ranks::end_for_all(std::exception_ptr const& failure) {
  send_all(*channel_, failure ? note_of(failure) : Note{Word::go});
  if (!failure) return;
  ended_together_ = true;
  std::rethrow_exception(failure);
}

}  // namespace polhode::bench