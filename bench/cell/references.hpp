#pragma once
/// The references of a run: each is made once, and shared by the cells that are held against it.
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "bench/cell/prepare.hpp"
#include "bench/cell/reference.hpp"

namespace polhode::bench {

/// A reference, or why there is none.
struct FoundReference {
  std::shared_ptr<UsableReference const> reference;
  std::string why_none;
};

/// References by subject, each made once and shared between threads.
class References {
 public:
  explicit References(std::filesystem::path committed) : committed_(std::move(committed)) {}
  /// `whole` [s]: a longer horizon whose committed reference serves, too. Throws ReferenceError if a committed one is
  /// damaged or stale.
  FoundReference of(PreparedCell const& prepared, double whole = 0);

 private:
  struct Slot {
    std::once_flag made;
    std::string why_none;
    std::shared_ptr<UsableReference const> reference;
  };
  std::filesystem::path committed_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Slot>> slots_;
};

}  // namespace polhode::bench
