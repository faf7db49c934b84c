/// The verbs export and merge: records as other tools want them, and several folders as one.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/process/messages.hpp"
#include "results/export.hpp"
#include "results/merge.hpp"
#include "results/store.hpp"

namespace polhode::bench {
namespace {

void export_records(std::string const& folder, std::string const& format, std::string const& out) {
  std::vector<std::string> const formats{"csv", "benchmark-json"};
  if (std::ranges::find(formats, format) == formats.end()) throw UsageError(unknown("format", format, formats));
  results::Contents const contents = results::read(folder);
  if (contents.records.empty())
    throw NothingSelected(fmt::format("{}: holds no records; `polhode run` makes them", folder));
  if (format == "csv") return write_out(out, results::csv_text(contents.records));
  std::size_t const left_out = results::left_out_of_benchmarks(contents);
  if (left_out == contents.records.size())
    throw NothingSelected(fmt::format("{}: no run of the newest build was timed", folder));
  write_out(out, results::benchmark_json_text(contents));
  if (left_out > 0)
    fmt::print(stderr, "polhode: {} of {} records left out: not timed, or of an older build\n", left_out,
               contents.records.size());
}

/// What a merge left where it is.
void tell_of(std::vector<std::filesystem::path> const& left) {
  constexpr std::size_t most = 8;
  if (left.empty()) return;
  std::string text;
  for (std::size_t i = 0; i < std::min(left.size(), most); ++i) text += (i > 0 ? ", " : "") + left[i].string();
  if (left.size() > most) text += fmt::format(" and {} more", left.size() - most);
  fmt::print(stderr, "polhode: left where they are: {}\n", text);
}

void add_merge(CLI::App& app) {
  auto const out = std::make_shared<std::string>();
  auto const folders = std::make_shared<std::vector<std::string>>();
  CLI::App* verb = app.add_subcommand("merge", "Make one result folder from several, such as the shards of a suite");
  verb->add_option("OUT", *out, "Folder to write; holds no records yet")->required();
  verb->add_option("DIR", *folders, "Result folders; of runs of one cell and build, the last counts")->required();
  verb->callback([=] {
    results::MergeSummary const summary = results::merge(*out, {folders->begin(), folders->end()});
    fmt::print("{}: {} records from {} files of {} folders; {} repeated runs left out\n", *out, summary.records,
               summary.files, summary.folders, summary.repeated);
    tell_of(summary.left);
  });
}

}  // namespace

void add_export(CLI::App& app) {
  auto const folder = std::make_shared<std::string>();
  auto const format = std::make_shared<std::string>("csv");
  auto const out = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("export", "Write the records of a folder as CSV or Google Benchmark JSON");
  verb->add_option("DIR", *folder, "Result folder of `polhode run`")->required();
  verb->add_option("--format", *format, "csv or benchmark-json")->capture_default_str();
  verb->add_option("--out", *out, "File instead of standard output")->type_name("FILE");
  verb->callback([=] { export_records(*folder, *format, *out); });
  add_merge(app);
}

}  // namespace polhode::bench
