#include "bench/ensemble/ensemble.hpp"

#include <exception>
#include <thread>

namespace polhode::bench {

void on_threads(int threads, std::int64_t parts, std::function<void(std::int64_t)> const& work) {
  auto const shares = std::int64_t(std::max(1, threads));
  std::vector<std::exception_ptr> failures(std::size_t(shares), nullptr);
  auto const share = [&](std::int64_t i) {
    try {
      for (std::int64_t k = parts * i / shares; k < parts * (i + 1) / shares; ++k) work(k);
    } catch (...) {
      failures[std::size_t(i)] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::int64_t i = 1; i < shares; ++i) others.emplace_back(share, i);
    share(0);
  }
  for (std::exception_ptr const& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace polhode::bench
