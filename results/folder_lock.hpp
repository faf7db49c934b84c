#pragma once
/// One writer at a time: a lock on a result folder. The system releases it when the process ends, however it ends.
#include <filesystem>

namespace polhode::results {

/// Holds the folder until it is destroyed. The folder is there. Where locks are not possible (no leave to write, a file
/// system without them) it holds nothing, and who writes meets the reason.
class FolderLock {
 public:
  /// The whole folder. Throws StoreError if another process holds it, or a part of it.
  explicit FolderLock(std::filesystem::path const& folder);
  /// One part of several, beside others who hold other parts: shards of one suite may share a folder. Throws StoreError
  /// if another process holds the folder or the same part.
  FolderLock(std::filesystem::path const& folder, int part, int parts);
  ~FolderLock();
  FolderLock(FolderLock const&) = delete;
  FolderLock& operator=(FolderLock const&) = delete;

 private:
  int folder_ = -1, part_ = -1;  ///< descriptors
};

}  // namespace polhode::results
