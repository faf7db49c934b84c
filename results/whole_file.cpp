#include "results/whole_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "results/store.hpp"

namespace polhode::results {

namespace fs = std::filesystem;

void write_whole(fs::path const& file, std::string_view text) {
  auto const cannot = [](fs::path const& which, std::error_code error) {
    return StoreError(fmt::format("{}: cannot be written: {}", which.string(), error.message()));
  };
  std::error_code error;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  if (error) throw cannot(file, error);
  fs::path const draft = fmt::format("{}.{}", file.string(), ::getpid());
  errno = 0;
  std::ofstream out(draft, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw cannot(draft, {errno, std::generic_category()});
  fs::rename(draft, file, error);
  if (error) throw cannot(file, error);
}

}  // namespace polhode::results
