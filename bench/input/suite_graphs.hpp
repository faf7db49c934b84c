#pragma once
/// Graphs in files, and those that a suite names.
#include <filesystem>
#include <vector>

namespace polhode::bench {

/// The links in a file, three numbers each. Throws ParameterError: what is wrong, with file and line.
std::vector<double> read_graph_file(std::filesystem::path const& file);

/// Reads those of a suite, once each or often, and remembers which: `run` copies them into the result folder, beside
/// the suite. So every one needs a name of its own there.
class GraphFiles {
 public:
  /// folder: that of the suite.
  explicit GraphFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// The links in a file, found by its path from the suite's folder; in a result folder, the copy. Throws
  /// ParameterError: what is wrong with the file; a name that a result folder has for itself; a second file of one
  /// name.
  std::vector<double> read(std::filesystem::path const& written);
  /// Every file that was read, once.
  std::vector<std::filesystem::path> const& files() const { return files_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace polhode::bench
