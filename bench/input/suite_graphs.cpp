#include "bench/input/suite_graphs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "problems/graph.hpp"
#include "results/file_name.hpp"
#include "results/store.hpp"

namespace polhode::bench {

namespace fs = std::filesystem;

std::vector<double> read_graph_file(fs::path const& file) {
  try {
    std::ifstream in = results::open_regular(file, results::most_text);
    return read_graph(in, file.string());
  } catch (results::StoreError const& error) {
    throw ParameterError(fmt::format("parameter graph: {}", error.what()));
  }
}

std::vector<double> GraphFiles::read(fs::path const& written) {
  std::error_code none;
  std::string const name = written.filename().string(), plain = results::file_name_of(name);
  if (name != plain || results::is_own_name(name))
    throw ParameterError(
        fmt::format("parameter graph: a result folder, where it is copied to, cannot hold a graph called '{}'; rename "
                    "it, e.g. graph.txt",
                    plain));
  // A copy counts: what the path leads to from here is another file, or has changed.
  fs::path const beside = folder_ / name;
  bool const copied = fs::exists(folder_ / results::catalogue_file, none) && fs::exists(beside, none);
  fs::path const file = copied || !fs::exists(folder_ / written, none) ? beside : folder_ / written;
  auto const same_name = std::ranges::find(files_, file.filename(), &fs::path::filename);
  if (same_name == files_.end())
    files_.push_back(file);
  else if (*same_name != file && !fs::equivalent(*same_name, file, none))
    throw ParameterError(
        fmt::format("parameter graph: {} and {} have one name, but are copied to one folder; rename one",
                    same_name->string(), file.string()));
  return read_graph_file(file);
}

}  // namespace polhode::bench
