#pragma once
/// Names that come from outside, in suites and records, as names of files.
#include <string>

namespace polhode::results {

/// `name` as the name of one file or folder, never a path: '/' and control characters become '_', and one is put before
/// a '.' that it begins with.
inline std::string file_name_of(std::string name) {
  if (name.empty() || name.front() == '.') name.insert(name.begin(), '_');
  for (char& c : name)
    if (c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '_';
  constexpr std::size_t longest = 200;  // file systems allow 255 bytes, and endings follow
  if (name.size() > longest) name.resize(longest);
  return name;
}

}  // namespace polhode::results
