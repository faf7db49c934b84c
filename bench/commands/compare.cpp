/// The verb compare: two sets of records, held against each other.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.hpp"
#include "bench/input/cell_flags.hpp"
#include "bench/process/messages.hpp"
#include "results/compare.hpp"
#include "results/store.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench {
namespace {

struct CompareOptions {
  std::string a, b, format;
  std::vector<std::string> files;  ///< --out
  std::string html, json;
  bool fail = false;
  results::CompareRules rules;
};

std::vector<std::string> const formats{"text", "markdown", "html", "json"};

/// By the name of the file.
std::string format_of(std::string const& file) {
  if (file.ends_with(".html") || file.ends_with(".htm")) return "html";
  if (file.ends_with(".json")) return "json";
  if (file.ends_with(".md")) return "markdown";
  return file.ends_with(".txt") ? "text" : "";
}

void check_format(std::string const& format) {
  if (std::ranges::find(formats, format) == formats.end()) throw UsageError(unknown("format", format, formats));
}

void check_options(CompareOptions const& options) {
  if (!options.format.empty()) check_format(options.format);
  for (std::string const& file : options.files) {
    if (format_of(file).empty() && options.format.empty())
      throw UsageError(
          fmt::format("--out {}: end its name in .md, .html, .json or .txt, or give --format", quote(file)));
  }
  auto const positive = [](char const* flag, double value) {
    if (!(value >= 0) || std::isinf(value))
      throw UsageError(fmt::format("--{} = {}: must be a number from 0 on", flag, value));
  };
  positive("digits", options.rules.digits);
  positive("counts", options.rules.counts);
  positive("time", options.rules.time);
}

std::string text_of(results::Comparison const& comparison, std::string const& format, WriteComparison const& write,
                    results::Outlet const& outlet) {
  if (format == "json")
    return to_json(comparison).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  ComparisonForm const form = format == "html"   ? ComparisonForm::html
                              : format == "text" ? ComparisonForm::terminal
                                                 : ComparisonForm::markdown;
  return write(comparison, form, outlet);
}

results::Contents read_records(std::string const& path) {
  results::Contents contents = results::read(path);
  if (contents.records.empty())
    throw NothingSelected(fmt::format("{}: holds no records; `polhode run` makes them", path));
  return contents;
}

int compare(CompareOptions const& options, WriteComparison const& write) {
  check_options(options);
  results::Comparison const comparison =
      results::compare(read_records(options.a), read_records(options.b), options.a, options.b, options.rules);
  if (comparison.common == 0)
    throw NothingSelected(fmt::format("{} and {} have no cell in common", options.a, options.b));
  auto const put = [&](std::string const& file, std::string const& format) {
    results::write_text(file, text_of(comparison, format, write, {}));
  };
  for (std::string const& file : options.files) put(file, options.format.empty() ? format_of(file) : options.format);
  if (!options.html.empty()) put(options.html, "html");
  if (!options.json.empty()) put(options.json, "json");
  bool const to_files = !options.files.empty() || !options.html.empty() || !options.json.empty();
  if (!to_files) {
    std::string const usual = ::isatty(STDOUT_FILENO) != 0 ? "text" : "markdown";
    std::string const& format = options.format.empty() ? usual : options.format;
    write_out("", text_of(comparison, format, write, results::outlet_of(STDOUT_FILENO)));
  }
  return options.fail && comparison.regressed() ? exit_expectation_failed : exit_ok;
}

}  // namespace

void add_compare(CLI::App& app, int& code, WriteComparison const& write) {
  auto const options = std::make_shared<CompareOptions>();
  CLI::App* verb = app.add_subcommand("compare", "Hold two sets of records against each other: what got worse in B?");
  verb->add_option("A", options->a, "Result folder of `polhode run`, or one of its files")->required();
  verb->add_option("B", options->b, "Another")->required();
  verb->add_option("--out", options->files, "File instead of standard output: .md, .html, .json or .txt; repeatable")
      ->type_name("FILE")
      ->allow_extra_args(false);
  verb->add_option("--html", options->html, "Write a page")->type_name("FILE");
  verb->add_option("--json", options->json, "Write it for tools")->type_name("FILE");
  verb->add_option("--format", options->format,
                   "text, markdown, html or json; default text on a terminal, else markdown");
  verb->add_flag("--fail-on-regression", options->fail,
                 "Exit with 1 if a status, a verdict, an error or a count is worse; seconds never count");
  add_number(*verb, "--digits", options->rules.digits, "Errors that change by less are the same [log10]")
      ->capture_default_str();
  add_number(*verb, "--counts", options->rules.counts, "Counts that change by less are the same [part]")
      ->capture_default_str();
  add_number(*verb, "--time", options->rules.time, "Times that change by less are the same [part]")
      ->capture_default_str();
  verb->callback([=, &code] { code = compare(*options, write); });
}

}  // namespace polhode::bench
