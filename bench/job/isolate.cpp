#include "bench/job/isolate.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <list>
#include <system_error>
#include <utility>
#include <vector>

#include "bench/process/clock.hpp"

namespace polhode::bench {
namespace {

[[noreturn]] void fail(char const* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// One child: killed and reaped when it goes, unless it was already.
class Child {
 public:
  Child(std::size_t which, double limit, std::function<std::string(std::size_t)> const& work)
      : number(which), limit_(limit) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail("a pipe for an isolated cell");
    pid_t const parent = ::getpid();
    pid_ = ::fork();
    if (pid_ < 0) {
      int const reason = errno;
      ::close(ends[0]);
      ::close(ends[1]);
      errno = reason;
      fail("a process for an isolated cell");
    }
    if (pid_ == 0) live(ends[1], parent, work);
    ::close(ends[1]);
    from_ = ends[0];
  }
  ~Child() {
    if (from_ >= 0) ::close(from_);
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    reap();
  }
  Child(Child const&) = delete;
  Child& operator=(Child const&) = delete;

  int descriptor() const { return from_; }
  /// Reads what there is; true at the end.
  bool read_some() {
    char buffer[1 << 16];
    ssize_t const got = ::read(from_, buffer, sizeof buffer);
    if (got > 0) ended_.text.append(buffer, std::size_t(got));
    return got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN);
  }
  void kill_if_late() {
    if (ended_.late || !limit_.passed()) return;
    ended_.late = true;
    ::kill(pid_, SIGKILL);
  }
  Ended finish() {
    int const status = reap();
    if (WIFSIGNALED(status)) {
      char const* name = ::sigabbrev_np(WTERMSIG(status));
      ended_.died = name ? fmt::format("SIG{}", name) : fmt::format("signal {}", WTERMSIG(status));
    } else if (WEXITSTATUS(status) == threw) {
      ended_.died = "exception: " + std::exchange(ended_.text, "");
    } else if (WEXITSTATUS(status) != 0) {
      ended_.died = fmt::format("exit code {}", WEXITSTATUS(status));
    }
    return std::move(ended_);
  }

  std::size_t number;

 private:
  /// The child's whole life. It leaves by _exit: buffers and locks that it inherited are not its own.
  [[noreturn]] void live(int to, pid_t parent, std::function<std::string(std::size_t)> const& work) const {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(unheard);  // it died in between
    rlimit const no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    try {
      send(to, work(number));
    } catch (std::exception const& error) {
      send(to, error.what());
      ::_exit(threw);
    } catch (...) {
      ::_exit(threw);
    }
    ::_exit(0);
  }
  static void send(int to, std::string const& text) {
    for (std::size_t sent = 0; sent < text.size();) {
      ssize_t const now = ::write(to, text.data() + sent, text.size() - sent);
      if (now < 0 && errno != EINTR) ::_exit(unheard);
      if (now > 0) sent += std::size_t(now);
    }
  }
  int reap() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = 0;
    return status;
  }

  static constexpr int threw = 70, unheard = 71;  ///< exit codes
  pid_t pid_ = 0;
  int from_ = -1;
  TimeLimit limit_;
  Ended ended_;
};

}  // namespace

void in_children(std::size_t count, int processes, double limit, std::atomic<bool> const& stop,
                 std::function<void(std::size_t)> const& begin, std::function<std::string(std::size_t)> const& work,
                 std::function<void(std::size_t, Ended const&)> const& done) {
  constexpr int patience = 50;  // [ms] between looks at the clock and at `stop`
  std::list<Child> children;
  for (std::size_t next = 0; (next < count || !children.empty()) && !stop;) {
    while (next < count && int(children.size()) < processes) {
      begin(next);
      children.emplace_back(next, limit, work);
      ++next;
    }
    std::vector<pollfd> waiting;
    for (Child const& child : children) waiting.push_back({child.descriptor(), POLLIN, 0});
    if (::poll(waiting.data(), nfds_t(waiting.size()), patience) < 0 && errno != EINTR) fail("poll");
    std::size_t k = 0;
    for (auto child = children.begin(); child != children.end(); ++k) {
      child->kill_if_late();
      bool const ended = waiting[k].revents != 0 && child->read_some();
      auto const here = child++;
      if (!ended) continue;
      std::size_t const number = here->number;
      Ended const what = here->finish();
      children.erase(here);
      if (!stop) done(number, what);
    }
  }
}

}  // namespace polhode::bench
