#include "results/folder_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "results/store.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;

void release(int descriptor) {
  if (descriptor >= 0) ::close(descriptor);
}

/// A descriptor that holds the lock; -1 where that is not possible. `operation` is LOCK_EX or LOCK_SH.
int hold(fs::path const& folder, std::string const& name, int operation) {
  fs::path const file = folder / name;
  int const descriptor = ::open(file.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) return -1;
  if (::flock(descriptor, operation | LOCK_NB) == 0) return descriptor;
  bool const taken = errno == EWOULDBLOCK;
  ::close(descriptor);
  if (!taken) return -1;
  throw StoreError(
      fmt::format("{}: another process is writing results there; wait for it, or give another folder with "
                  "--out",
                  folder.string()));
}

}  // namespace

FolderLock::FolderLock(fs::path const& folder) : folder_(hold(folder, ".lock", LOCK_EX)) {}

FolderLock::FolderLock(fs::path const& folder, int part, int parts) : folder_(hold(folder, ".lock", LOCK_SH)) {
  try {
    part_ = hold(folder, fmt::format(".lock-{}-of-{}", part, parts), LOCK_EX);
  } catch (...) {
    release(folder_);
    throw;
  }
}

FolderLock::~FolderLock() {
  release(part_);
  release(folder_);
}

}  // namespace polhode::results
