/// The verb check: expectations of a suite against the records of a folder, and its golden columns.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>

#include "bench/cell/cell.hpp"
#include "bench/commands/commands.hpp"
#include "bench/process/data.hpp"
#include "bench/process/provenance.hpp"
#include "bench/score/check.hpp"
#include "bench/score/check_report.hpp"
#include "results/file_name.hpp"
#include "results/store.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench {
namespace {

using results::GoldenLine;

struct CheckOptions {
  std::string folder, junit, markdown, golden;
  bool update = false;
};

/// The suite of a result folder, with the records that it is held against.
struct Checked {
  Suite suite;
  CheckSubject subject;
  std::vector<CheckedCell> cells;
  results::Contents contents;  ///< keeps the records
};

void write_file(std::string const& file, std::string const& text) {
  if (!file.empty()) results::write_text(file, text);
}

/// Where GitHub runs this: failures as annotations, and the summary of the step. The file belongs to the whole step, so
/// it is continued.
void tell_github(CheckSubject const& subject, std::vector<Row> const& rows) {
  char const* actions = std::getenv("GITHUB_ACTIONS");
  if (actions == nullptr || std::strcmp(actions, "true") != 0) return;
  fmt::print("{}", github_text(subject, rows));
  char const* summary = std::getenv("GITHUB_STEP_SUMMARY");
  if (summary == nullptr || *summary == '\0') return;
  errno = 0;
  std::ofstream out(summary, std::ios::binary | std::ios::app);
  out << markdown_text(subject, rows) << '\n';
  out.close();
  if (!out) throw results::StoreError(fmt::format("{}: cannot be written: {}", summary, std::strerror(errno)));
}

/// What the meta says under a key; empty if nothing.
std::string entry(results::Meta const& meta, char const* key) {
  auto const found = meta.find(key);
  return found == meta.end() ? "" : found->second;
}

/// When and from which commit, as far as the meta tells.
std::string made_text(results::Meta const& meta) {
  std::vector<std::string> parts;
  auto const note = [&](char const* key, char const* label) {
    if (std::string const value = entry(meta, key); !value.empty()) parts.push_back(label + value);
  };
  note("utc", "");
  note("version", "version ");
  note("git_commit", "commit ");
  if (entry(meta, "git_dirty") == "true") parts.push_back("modified");
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The newest build's records: those of the build that wrote the last file.
Checked open_folder(std::string const& folder) {
  Checked checked;
  checked.subject.file = (std::filesystem::path(folder) / "suite.toml").string();
  checked.suite = read_suite(checked.subject.file, vocabulary());
  checked.contents = results::read(folder);
  auto const& metas = checked.contents.metas;
  if (metas.empty()) throw NothingSelected(fmt::format("{}: holds no records; `polhode run` makes them", folder));
  results::Meta const& newest = metas.back();
  checked.subject.suite = checked.suite.name;
  checked.subject.build = entry(newest, "build");
  checked.subject.source = entry(newest, "suite_file");
  checked.subject.made = made_text(newest);
  checked.cells = pair_up(checked.suite, checked.contents, checked.subject.build);
  checked.subject.cells = checked.cells.size();
  for (CheckedCell const& cell : checked.cells) checked.subject.records += cell.record != nullptr;
  return checked;
}

std::filesystem::path golden_file(CheckOptions const& options, std::string const& suite) {
  std::filesystem::path const folder =
      options.golden.empty() ? references_folder().parent_path() / "golden" : std::filesystem::path(options.golden);
  return folder / (results::file_name_of(suite) + ".jsonl");
}

// --- Update ----------------------------------------------------------------------------------------------------------

/// What depends on the machine's speed, or on luck, is no golden result.
bool is_deterministic(results::Record const& record) {
  return record.status != results::Status::timeout && record.status != results::Status::crashed;
}

/// A golden line for every cell of the suite that ran; those that did not run keep theirs.
std::vector<GoldenLine> golden_now(Checked const& checked, std::vector<GoldenLine> const& before) {
  GoldenByCell old;
  for (GoldenLine const& line : before) old[line.cell] = line;
  std::vector<GoldenLine> now;
  for (CheckedCell const& cell : checked.cells) {
    auto const committed = old.find(cell.id);
    bool const ran = cell.record && is_deterministic(*cell.record);
    if (!ran && committed != old.end()) now.push_back(committed->second);
    if (!ran) continue;
    GoldenLine const measured = results::golden_of(*cell.record);
    now.push_back(committed == old.end() ? measured : results::settled(committed->second, measured));
  }
  return now;
}

int update_golden(CheckOptions const& options) {
  Checked const checked = open_folder(options.folder);
  if (checked.subject.records == 0)
    throw NothingSelected(fmt::format("{}: holds no record of a cell of its suite", options.folder));
  std::filesystem::path const file = golden_file(options, checked.suite.name);
  std::vector<GoldenLine> const before = results::read_golden(file);
  std::vector<GoldenLine> const now = golden_now(checked, before);
  std::vector<std::string> const changes = results::difference(before, now);
  for (std::string const& change : changes) fmt::print("{}\n", change);
  if (!changes.empty()) results::write_golden(file, checked.suite.name, now);
  fmt::print("{}: {} lines, {} changed\n", file.string(), now.size(), changes.size());
  std::size_t const left = checked.cells.size() - checked.subject.records;
  if (left > 0) fmt::print("{} of {} cells have not run; their lines are as they were\n", left, checked.cells.size());
  return 0;
}

// --- Check -----------------------------------------------------------------------------------------------------------

/// Nothing to judge is no pass.
void require_something(Checked const& checked, std::vector<Row> const& rows) {
  if (rows.empty()) throw NothingSelected(fmt::format("{}: has no [[expect]]", checked.subject.file));
  bool const any = std::ranges::any_of(rows, [](Row const& row) { return row.cells > 0; });
  if (!any)
    throw NothingSelected(fmt::format("{}: no expectation selects a cell with a record of build {}",
                                      checked.subject.file, checked.subject.build));
}

int check(CheckOptions const& options) {
  Checked const checked = open_folder(options.folder);
  GoldenByCell golden;
  for (GoldenLine& line : results::read_golden(golden_file(options, checked.suite.name))) {
    std::string const id = line.cell;
    golden[id] = std::move(line);
  }
  std::vector<Row> const rows = judge(checked.suite, checked.cells, vocabulary(), golden, checked.subject.file);
  require_something(checked, rows);
  fmt::print("{}", table_text(checked.subject, rows, results::outlet_of(STDOUT_FILENO)));
  if (!options.junit.empty()) write_file(options.junit, junit_text(checked.subject, rows));
  if (!options.markdown.empty()) write_file(options.markdown, markdown_text(checked.subject, rows));
  tell_github(checked.subject, rows);
  bool const good = std::ranges::all_of(rows, [](Row const& row) { return is_good(row.verdict); });
  return good ? 0 : exit_expectation_failed;
}

}  // namespace

void add_check(CLI::App& app, int& code) {
  auto const options = std::make_shared<CheckOptions>();
  CLI::App* verb = app.add_subcommand("check", "Hold the records of a folder against its suite's expectations");
  verb->add_option("DIR", options->folder, "Result folder of `polhode run`")->required();
  verb->add_option("--junit", options->junit, "Write JUnit XML")->type_name("FILE");
  verb->add_option("--markdown", options->markdown, "Write a summary in Markdown")->type_name("FILE");
  verb->add_option("--golden", options->golden, "Folder of golden columns; default the committed ones")
      ->type_name("DIR");
  verb->add_flag("--update", options->update,
                 "Make this run's results the golden ones and say what changes; not where CI is set");
  verb->callback([=, &code] {
    if (options->update && std::getenv("CI") != nullptr)
      throw UsageError("--update: not where CI is set; golden columns are changed by a person who read the difference");
    code = options->update ? update_golden(*options) : check(*options);
  });
}

}  // namespace polhode::bench
