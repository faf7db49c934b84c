#pragma once
/// What Linux says of the machine, below /proc and /sys. What it does not say is empty.
#include <filesystem>
#include <string>
#include <string_view>

namespace polhode::bench {

/// The first line of a file, which is all of most.
std::string first_line(std::filesystem::path const& file);
/// What follows `key` in lines such as "key: value", "key value" or "key\t: value"; of several lines the first.
std::string entry_of(std::filesystem::path const& file, std::string_view key);
/// A hypervisor runs it. `root` is / but for tests.
bool is_virtual(std::filesystem::path const& root = "/");

}  // namespace polhode::bench
