#include "results/merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "results/store.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;

/// One file that was read.
struct Part {
  std::string stem;
  Contents contents;
};

/// A cell and a build.
using Key = std::pair<std::string, std::string>;

constexpr char const* suite_file = "suite.toml";

/// A file beside the records.
struct Copy {
  std::string text;
  fs::path from;
};

/// Such files by their names.
using Copies = std::map<std::string, Copy>;

/// The suite of the first folder that has one; empty if none has.
std::string suite_of(std::vector<fs::path> const& folders) {
  auto const as_it_is = [](std::string text) { return text; };
  for (fs::path const& folder : folders)
    if (auto suite = read_if_there(folder / suite_file, as_it_is)) return *suite;
  return {};
}

/// What stands in a folder; locks, drafts, records and the catalogue, which is joined, are passed over.
std::vector<fs::path> others_in(fs::path const& folder) try {
  std::vector<fs::path> others;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder)) {
    std::string const name = entry.path().filename().string();
    bool const copied = name == suite_file || name == benchmarks_file || name == ensemble_file;
    if (copied || !is_own_name(name)) others.push_back(entry.path());
  }
  std::ranges::sort(others);
  return others;
} catch (fs::filesystem_error const& error) {
  throw StoreError(fmt::format("{}: cannot be read: {}", folder.string(), error.code().message()));
}

/// Does the suite name such a file, in a string, by itself or at the end of a path?
bool names_file(std::string_view suite, std::string_view name) {
  constexpr std::string_view before = "\"'/", after = "\"'";
  for (std::size_t at = suite.find(name); at < suite.size(); at = suite.find(name, at + 1)) {
    std::size_t const end = at + name.size();
    bool const whole = at > 0 && before.find(suite[at - 1]) != std::string_view::npos && end < suite.size() &&
                       after.find(suite[end]) != std::string_view::npos;
    if (whole) return true;
  }
  return false;
}

/// Adds what a folder has beside its records: the suite and its graphs, which all folders share, and measurements, of
/// which the last count. What is none of these, or does not count, is left.
void collect(fs::path const& folder, std::string const& suite, Copies& copies, std::vector<fs::path>& left) {
  for (fs::path const& file : others_in(folder)) {
    std::string const name = file.filename().string();
    bool const measured = name == benchmarks_file || name == ensemble_file;
    // The suite cannot be read without the graphs that it names.
    bool const shared = name == suite_file || (!fs::is_directory(file) && names_file(suite, name));
    if (!measured && !shared) {
      left.push_back(file);
      continue;
    }
    Copy copy{read_whole(file), file};
    auto const [place, is_new] = copies.try_emplace(name, copy);
    if (is_new || place->second.text == copy.text) continue;
    if (shared)
      throw StoreError(fmt::format("{}: another {} than {}; merge results of one suite", file.string(),
                                   name == suite_file ? "suite" : "graph", place->second.from.string()));
    left.push_back(place->second.from);
    place->second = std::move(copy);
  }
}

/// The place of the run that counts: the last of each cell and build.
std::map<Key, std::size_t> last_runs(std::vector<Part> const& parts) {
  std::map<Key, std::size_t> last;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (Record const& record : parts[i].contents.records) last[{record.cell, record.build}] = i;
  }
  return last;
}

/// Writes what of a part counts. The order within is that of a run: histories before the run that they belong to.
void write_part(fs::path const& file, Part const& part, std::set<std::string> const& counting,
                std::set<std::string> const& unfinished) {
  Meta const& meta = part.contents.metas.front();
  auto const build = meta.find("build");
  Writer writer(file, meta);
  for (std::string const& cell : part.contents.unfinished) {
    if (unfinished.contains(cell) && build != meta.end()) writer.begin(cell, build->second);
  }
  std::map<std::string, std::vector<Series const*>> series;
  for (Series const& one : part.contents.series) series[one.cell].push_back(&one);
  for (Record const& record : part.contents.records) {
    if (!counting.contains(record.cell + record.build)) continue;
    for (Series const* one : series[record.cell]) writer.series(*one);
    writer.run(record);
  }
}

/// A folder without records may hold what would be written over.
void refuse_to_replace(fs::path const& out, Copies const& copies) {
  for (auto const& [name, copy] : copies)
    read_if_there(out / name, [&](std::string const& text) {
      if (text != copy.text) throw std::invalid_argument("is there already, and another; give a new folder");
      return true;
    });
}

}  // namespace

MergeSummary merge(fs::path const& out, std::vector<fs::path> const& folders) {
  bool const taken = fs::exists(out) && !record_files(out).empty();
  if (taken) throw StoreError(fmt::format("{}: holds records already; give a new folder", out.string()));
  MergeSummary summary;
  std::vector<Part> parts;
  for (fs::path const& folder : folders) {
    if (!fs::is_directory(folder)) throw StoreError(fmt::format("{}: no such folder", folder.string()));
    ++summary.folders;
    static_cast<void>(read_benchmarks(folder));  // damage is refused, not copied
    static_cast<void>(read_ensemble(folder));
    for (fs::path const& file : record_files(folder)) {
      Contents contents = read(file);
      summary.repeated += contents.repeated;
      bool const killed_at_birth = contents.metas.empty();
      if (!killed_at_birth) parts.push_back({file.stem().string(), std::move(contents)});
    }
  }
  Copies copies;
  std::string const suite = suite_of(folders);
  for (fs::path const& folder : folders) collect(folder, suite, copies, summary.left);
  refuse_to_replace(out, copies);
  auto const catalogue = merged_catalogues(folders);
  auto const last = last_runs(parts);

  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw StoreError(fmt::format("{}: cannot be made: {}", out.string(), error.message()));
  for (auto const& [name, copy] : copies) write_whole(out / name, copy.text);
  if (catalogue) write_catalogue(out, *catalogue);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Contents const& contents = parts[i].contents;
    std::set<std::string> counting;
    for (Record const& record : contents.records) {
      bool const counts = last.at({record.cell, record.build}) == i;
      if (counts) counting.insert(record.cell + record.build);
    }
    // A begin whose run is elsewhere was run again.
    std::set<std::string> unfinished;
    auto const build = contents.metas.front().find("build");
    for (std::string const& cell : contents.unfinished) {
      bool const never_ran = build != contents.metas.front().end() && !last.contains({cell, build->second});
      if (never_ran) unfinished.insert(cell);
    }
    write_part(out / fmt::format("{:04}-{}.jsonl", i + 1, parts[i].stem), parts[i], counting, unfinished);
    summary.records += counting.size();
    summary.repeated += contents.records.size() - counting.size();
  }
  summary.files = parts.size();
  return summary;
}

}  // namespace polhode::results
