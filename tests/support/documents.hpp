#pragma once
/// The Markdown files of the sources, and their text with and without code.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace polhode::test {

/// Every Markdown file, as a path from the root of the sources.
inline std::vector<std::filesystem::path> documents() {
  namespace fs = std::filesystem;
  std::set<std::string> const not_ours{".git", "build", "node_modules", "polhode-results"};
  std::vector<fs::path> all;
  fs::path const root = POLHODE_SOURCE_DIR;
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator(); ++entry) {
    if (not_ours.contains(entry->path().filename())) entry.disable_recursion_pending();
    if (entry->path().extension() == ".md") all.push_back(fs::relative(entry->path(), root));
  }
  return all;
}

/// The text of a file; `path` is from the root of the sources.
inline std::string contents(std::filesystem::path const& path) {
  std::ifstream in(std::filesystem::path(POLHODE_SOURCE_DIR) / path);
  if (!in) throw std::runtime_error(path.string() + " is not there");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Markdown in two parts: what stands in blocks of code, and the rest.
struct Parts {
  std::string code, prose;
};
inline Parts parts_of(std::string const& markdown) {
  std::istringstream in(markdown);
  Parts parts;
  bool code = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```"))
      code = !code;
    else
      (code ? parts.code : parts.prose) += line + '\n';
  }
  return parts;
}

}  // namespace polhode::test
