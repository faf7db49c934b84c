/// The command line, and the one file that sees both the harness and the report.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <new>
#include <system_error>

#include "bench/commands/commands.hpp"
#include "bench/job/ranks.hpp"
#include "bench/process/messages.hpp"
#include "bench/process/provenance.hpp"
#include "report/comparison.hpp"
#include "report/render/trajectory.hpp"
#include "report/report.hpp"
#include "results/store.hpp"
#include "results/terminal.hpp"

namespace {

using namespace polhode;

int complain(int code, std::string const& what) {
  std::fputs(("polhode: " + what + "\n").c_str(), stderr);
  return code;
}

std::vector<std::string> verb_names(CLI::App const& app) {
  std::vector<std::string> names;
  for (CLI::App const* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

/// What a report consists of, for a person at a terminal.
std::string written_files(std::filesystem::path const& folder) {
  std::map<std::string, std::map<std::string, int>> counts;
  for (char const* part : {"tables", "figures"}) {
    for (auto const& entry : std::filesystem::directory_iterator(folder / part))
      ++counts[part][entry.path().extension().string()];
  }
  auto const files = [&](char const* part) { return (folder / part).string(); };
  auto const count = [&](char const* part, char const* kind) {
    return fmt::format("{} *{}", counts[part][kind], kind);
  };
  return text_table({{"part"}, {"files", false, true}, {"where"}},
                    {{"text", "report.md", folder.string()},
                     {"tables", count("tables", ".csv") + ", " + count("tables", ".tex"), files("tables")},
                     {"figures", count("figures", ".svg") + ", " + count("figures", ".pdf"), files("figures")}},
                    results::outlet_of(STDOUT_FILENO));
}

void add_report(CLI::App& app) {
  static std::string folder, out;
  CLI::App* verb = app.add_subcommand("report", "Make tables, figures and a page from a result folder");
  verb->add_option("DIR", folder, "Result folder of `polhode run`")->required();
  verb->add_option("--out", out, "Where to write; default DIR/report")->type_name("DIR");
  verb->callback([] {
    std::filesystem::path const target = out.empty() ? folder + "/report" : out;
    results::Contents const contents = results::read(folder);
    if (contents.metas.empty() && !contents.ensemble)
      throw results::StoreError(folder +
                                ": holds no results; give a folder that `polhode run` or `polhode ensemble` wrote");
    report::write_report(contents, target);
    if (::isatty(STDOUT_FILENO) != 0) fmt::print("{}", written_files(target));  // what scripts read is the line below
    fmt::print("{}\n", (target / "report.html").string());
  });
}

std::string comparison_in(results::Comparison const& comparison, bench::ComparisonForm form,
                          results::Outlet const& outlet) {
  switch (form) {
    case bench::ComparisonForm::html:
      return report::comparison_html(comparison);
    case bench::ComparisonForm::markdown:
      return report::comparison_markdown(comparison);
    default:
      return report::comparison_text(comparison, outlet);
  }
}

/// What stands where nothing was expected: a flag, a verb or an argument.
std::string explain_extra(std::string const& word, CLI::App const& app, CLI::App const& verb) {
  if (word.size() > 1 && word[0] == '-') {
    std::vector<std::string> known;
    for (CLI::Option const* option : verb.get_options())
      for (std::string const& name : option->get_lnames()) known.push_back("--" + name);
    std::string const flag = word.substr(0, word.find('='));
    std::string const meant = flag.starts_with("--") ? bench::nearest(flag, known) : "";
    return "unknown flag " + bench::quote(flag) + (meant.empty() ? "" : "; did you mean '" + meant + "'?");
  }
  if (&verb != &app) return "unexpected argument " + bench::quote(word);
  return bench::unknown("verb", word, verb_names(app));
}

/// CLI11's message in our words, with what was probably meant.
std::string explain(CLI::ParseError const& error, CLI::App const& app) {
  auto const chosen = app.get_subcommands();
  CLI::App const& verb = chosen.empty() ? app : *chosen.front();
  std::vector<std::string> const extra = app.remaining(true);
  bool const unplaced = chosen.empty() || dynamic_cast<CLI::ExtrasError const*>(&error);
  std::string text = error.what();
  std::string const what = text.substr(0, text.find(':'));
  if (unplaced && !extra.empty())
    text = explain_extra(extra.front(), app, verb);
  else if (dynamic_cast<CLI::RequiredError const*>(&error) && chosen.empty())
    text = fmt::format("no verb; choose from {}", fmt::join(verb_names(app), ", "));
  else if (text.find("At Most") != std::string::npos)
    text = what + " is given more than once";
  else if (dynamic_cast<CLI::ArgumentMismatch const*>(&error) && text.ends_with("missing"))
    text = what + ": a value is missing";
  return text + " (see `polhode " + (chosen.empty() ? "" : verb.get_name() + " ") + "--help`)";
}

/// Of what is wrong with the command line, which all ranks of an MPI job have.
int complain_once(std::string const& what) {
  return bench::speaks_for_the_job() ? complain(bench::exit_usage, what) : bench::exit_ok;
}

int complain_of_output(std::error_code const& reason) {
  return complain(bench::exit_bad_file, "standard output: cannot be written: " + reason.message());
}

/// The exit code, once everything is out: a full disk must not pass for success.
int finish(int code) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return code;
  return complain_of_output({errno, std::generic_category()});
}

}  // namespace

// What cannot even be told ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  CLI::App app{"Polhode: how well do integrators keep an attitude, and at what cost?", "polhode"};
  app.set_version_flag("--version", bench::version_text());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 ok, 1 an expectation failed, 2 usage, 3 nothing selected, 4 a run failed, 5 a bad file, "
      "130 interrupted.");
  int code = bench::exit_ok;
  bench::add_commands(app, code, {report::plot_trajectory, comparison_in});
  add_report(app);
  try {
    app.parse(argc, argv);
    return finish(code);
  } catch (CLI::Success const& success) {  // --help, --version
    return finish(app.exit(success));
  } catch (bench::EndedElsewhere const&) {
    return bench::exit_ok;
  } catch (CLI::ParseError const& error) {
    return complain_once(explain(error, app));
  } catch (bench::UsageError const& error) {
    return complain_once(error.what());
  } catch (bench::NothingSelected const& error) {
    return complain(bench::exit_nothing_selected, error.what());
  } catch (std::bad_alloc const&) {
    return complain(bench::exit_run_failed, "out of memory");
  } catch (std::system_error const& error) {
    return std::ferror(stdout) != 0 ? complain_of_output(error.code()) : complain(bench::exit_bad_file, error.what());
  } catch (std::exception const& error) {  // files: suites, records, references, reports
    return complain(bench::exit_bad_file, error.what());
  }
}
