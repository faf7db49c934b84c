#include "results/whole_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace polhode::results {
namespace {

namespace fs = std::filesystem;

StoreError cannot(char const* what, fs::path const& file, std::error_code const& why) {
  return StoreError(fmt::format("{}: cannot be {}: {}", file.string(), what, why.message()));
}

StoreError too_large(fs::path const& file, std::uintmax_t most_bytes) {
  return StoreError(fmt::format("{}: is larger than {} MiB", file.string(), most_bytes >> 20));
}

/// What stands where a file is expected; null for a file, and for what opening it will tell.
char const* name_of(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "directory";
    case fs::file_type::character:
    case fs::file_type::block:
      return "device";
    case fs::file_type::fifo:
      return "pipe";
    case fs::file_type::socket:
      return "socket";
    default:
      return nullptr;
  }
}

}  // namespace

std::ifstream open_regular(fs::path const& file, std::uintmax_t most_bytes) {
  std::error_code unreadable;  // opening it tells, too
  auto const type = fs::status(file, unreadable).type();
  if (char const* other = name_of(type))
    throw StoreError(fmt::format("{}: is a {}; give a file", file.string(), other));
  bool const huge = type == fs::file_type::regular && fs::file_size(file, unreadable) > most_bytes;
  if (huge && !unreadable) throw too_large(file, most_bytes);
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw cannot("read", file, {errno, std::generic_category()});
  return in;
}

std::string read_whole(fs::path const& file, std::uintmax_t most_bytes) {
  std::ifstream in = open_regular(file, most_bytes);
  std::string text;
  for (std::array<char, 1 << 16> part; in;) {
    in.read(part.data(), part.size());
    text.append(part.data(), std::size_t(in.gcount()));
    if (text.size() > most_bytes) throw too_large(file, most_bytes);  // it grew
  }
  if (in.bad()) throw StoreError(fmt::format("{}: cannot be read to its end", file.string()));
  return text;
}

void write_text(fs::path const& file, std::string_view text) {
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw cannot("written", file, {errno, std::generic_category()});
}

void write_whole(fs::path const& file, std::string_view text) {
  std::error_code error;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  if (error) throw cannot("written", file, error);
  fs::path const draft = fmt::format("{}.{}", file.string(), ::getpid());
  write_text(draft, text);
  fs::rename(draft, file, error);
  if (error) throw cannot("written", file, error);
}

}  // namespace polhode::results
