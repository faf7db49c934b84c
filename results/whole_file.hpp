#pragma once
/// Files of a user's, read; files of ours, which are whole or not there at all.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace polhode::results {

/// A file that cannot be read or written, or is damaged; what() names file, line and what is wrong.
struct StoreError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a file may hold that is read at once, and one that is read line by line [bytes].
inline constexpr std::uintmax_t most_text = std::uintmax_t{64} << 20, most_lines = std::uintmax_t{4} << 30;

/// Opens a regular file of at most `most_bytes`: of a device, a pipe or what fills the memory, nobody sees the end.
/// Throws StoreError: "FILE: is a directory; give a file".
std::ifstream open_regular(std::filesystem::path const& file, std::uintmax_t most_bytes = most_lines);

/// The text of such a file. Throws StoreError.
std::string read_whole(std::filesystem::path const& file, std::uintmax_t most_bytes = most_text);

/// What `parse` makes of its text; nothing if there is no file of that name. Throws StoreError; the
/// std::invalid_argument of `parse` becomes one, "FILE: what".
template <class Parse>
auto read_if_there(std::filesystem::path const& file, Parse&& parse) -> std::optional<decltype(parse(std::string()))> {
  std::error_code unreadable;  // which reading it tells, too
  bool const absent = std::filesystem::status(file, unreadable).type() == std::filesystem::file_type::not_found;
  if (absent) return {};
  try {
    return parse(read_whole(file));
  } catch (std::invalid_argument const& error) {
    throw StoreError(file.string() + ": " + error.what());
  }
}

/// Writes to `file` as it stands, which may be a device: what a user named. Throws StoreError.
void write_text(std::filesystem::path const& file, std::string_view text);

/// Writes a draft beside `file` and renames it; makes the folder. Throws StoreError; `file` is then as it was.
void write_whole(std::filesystem::path const& file, std::string_view text);

}  // namespace polhode::results
