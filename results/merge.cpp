#include "results/merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
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

std::vector<fs::path> record_files(fs::path const& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".jsonl" && !entry.is_directory()) files.push_back(entry.path());
  }
  if (error) throw StoreError(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  std::ranges::sort(files);
  return files;
}

std::optional<std::string> suite_of(fs::path const& folder) {
  fs::path const file = folder / "suite.toml";
  if (!fs::exists(file)) return {};
  std::ifstream in(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(in), {});
  if (!in) throw StoreError(fmt::format("{}: cannot be read", file.string()));
  return text;
}

/// The one suite that all folders are of; none if none has one.
std::optional<std::string> common_suite(std::vector<fs::path> const& folders) {
  std::optional<std::string> common;
  fs::path from;
  for (fs::path const& folder : folders) {
    auto const suite = suite_of(folder);
    if (!suite) continue;
    if (common && *common != *suite) {
      throw StoreError(fmt::format("{}: another suite than {}; merge results of one suite",
                                   (folder / "suite.toml").string(), (from / "suite.toml").string()));
    }
    common = suite;
    from = folder;
  }
  return common;
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

void prepare_folder(fs::path const& out, std::optional<std::string> const& suite) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw StoreError(fmt::format("{}: cannot be made: {}", out.string(), error.message()));
  if (!suite) return;
  errno = 0;
  std::ofstream file(out / "suite.toml", std::ios::binary);
  file << *suite;
  file.close();
  if (!file) {
    throw StoreError(fmt::format("{}: cannot be written: {}", (out / "suite.toml").string(),
                                 std::generic_category().message(errno)));
  }
}

/// The graph files that the suite names stand beside it, and it cannot be read without them.
void copy_graphs(fs::path const& out, std::vector<fs::path> const& folders, std::string const& suite) {
  try {
    for (fs::path const& folder : folders)
      for (fs::directory_entry const& entry : fs::directory_iterator(folder)) {
        std::string const name = entry.path().filename().string();
        bool const named = entry.is_regular_file() && !is_own_name(name) && suite.find(name) != std::string::npos;
        if (named) fs::copy_file(entry.path(), out / name, fs::copy_options::skip_existing);
      }
  } catch (fs::filesystem_error const& error) {
    throw StoreError(fmt::format("{}: cannot be copied: {}", error.path1().string(), error.code().message()));
  }
}

}  // namespace

MergeSummary merge(fs::path const& out, std::vector<fs::path> const& folders) {
  bool const taken = fs::is_directory(out) && !record_files(out).empty();
  if (taken) throw StoreError(fmt::format("{}: holds records already; give a new folder", out.string()));
  MergeSummary summary;
  std::vector<Part> parts;
  for (fs::path const& folder : folders) {
    if (!fs::is_directory(folder)) throw StoreError(fmt::format("{}: no such folder", folder.string()));
    ++summary.folders;
    for (fs::path const& file : record_files(folder)) {
      Contents contents = read(file);
      summary.repeated += contents.repeated;
      bool const killed_at_birth = contents.metas.empty();
      if (!killed_at_birth) parts.push_back({file.stem().string(), std::move(contents)});
    }
  }
  auto const suite = common_suite(folders);
  auto const catalogue = merged_catalogues(folders);
  auto const last = last_runs(parts);

  prepare_folder(out, suite);
  if (suite) copy_graphs(out, folders, *suite);
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
