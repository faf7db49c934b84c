#pragma once
/// Files that are whole or not there at all.
#include <filesystem>
#include <string_view>

namespace polhode::results {

/// Writes a draft beside `file` and renames it; makes the folder. Throws StoreError; `file` is then as it was.
void write_whole(std::filesystem::path const& file, std::string_view text);

}  // namespace polhode::results
