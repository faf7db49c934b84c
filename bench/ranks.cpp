#include "bench/ranks.hpp"

#include <utility>

namespace polhode::bench {

Ranks Ranks::of_this_job() {
  return Ranks(nullptr);
}

Ranks::Ranks(std::unique_ptr<Channel> channel) : channel_(std::move(channel)), unwinding_(std::uncaught_exceptions()) {}

Ranks::~Ranks() {
  bool const known_to_all = std::uncaught_exceptions() == unwinding_ || ended_together_;
  if (channel_ && known_to_all) channel_->leave();
}

void Ranks::together(std::function<void()> const& step) {
  step();
}

std::string Ranks::from_manager(std::function<std::string()> const& make) {
  return make();
}

void Ranks::distribute(std::int64_t count, std::function<std::string(std::int64_t)> const& work,
                       std::function<void(std::int64_t, std::string)> const& deliver, std::atomic<bool>* stop) {
  for (std::int64_t k = 0; k < count; ++k) {
    if (stop && *stop) return;
    std::string result = work(k);
    if (stop && *stop) return;
    deliver(k, std::move(result));
  }
}

bool speaks_for_the_job() {
  return true;
}

}  // namespace polhode::bench
