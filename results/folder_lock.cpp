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

/// What `descriptor` is open on, locked; -1 where that is not possible. `operation` is LOCK_EX or LOCK_SH.
int hold(int descriptor, fs::path const& folder, int operation) {
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

/// The folder itself is what is locked: no file of ours is left in it.
int hold_folder(fs::path const& folder, int operation) {
  return hold(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC), folder, operation);
}
/// A part has no folder of its own, but a file.
int hold_part(fs::path const& folder, std::string const& name) {
  fs::path const file = folder / name;
  return hold(::open(file.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666), folder, LOCK_EX);
}

}  // namespace

FolderLock::FolderLock(fs::path const& folder) : folder_(hold_folder(folder, LOCK_EX)) {}

FolderLock::FolderLock(fs::path const& folder, int part, int parts) : folder_(hold_folder(folder, LOCK_SH)) {
  try {
    part_ = hold_part(folder, fmt::format(".lock-{}-of-{}", part, parts));
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
