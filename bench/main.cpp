/// The command line, and the one file that sees both the harness and the report.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "bench/commands.hpp"
#include "report/report.hpp"
#include "results/store.hpp"

namespace {

using namespace polhode;

// A contract; see README.md.
enum Exit {
  exit_ok = 0,
  exit_usage = 2,
  exit_nothing_selected = 3,
  exit_run_failed = 4,
  exit_bad_file = 5,
  exit_interrupted = 130
};

int complain(int code, std::string const& what) {
  std::fputs(("polhode: " + what + "\n").c_str(), stderr);
  return code;
}

void add_report(CLI::App& app) {
  static std::string folder, out;
  CLI::App* verb = app.add_subcommand("report", "Make tables, figures and a page from a result folder");
  verb->add_option("DIR", folder, "Result folder of `polhode run`")->required();
  verb->add_option("--out", out, "Where to write; default DIR/report")->type_name("DIR");
  verb->callback([] {
    std::filesystem::path const target = out.empty() ? folder + "/report" : out;
    report::write_report(results::read(folder), target);
    fmt::print("{}\n", (target / "report.html").string());
  });
}

/// CLI11's message, with the flag that was probably meant.
std::string explain(CLI::ParseError const& error, CLI::App const& app) {
  std::string text = error.what();
  auto const chosen = app.get_subcommands();
  CLI::App const& verb = chosen.empty() ? app : *chosen.front();
  std::vector<std::string> known;
  for (CLI::Option const* option : verb.get_options())
    for (std::string const& name : option->get_lnames()) known.push_back("--" + name);
  auto const at = text.find("--");
  if (dynamic_cast<CLI::ExtrasError const*>(&error) && at != std::string::npos) {
    std::string const word = text.substr(at, text.find_first_of(" =", at) - at);
    std::string const meant = bench::nearest(word, known);
    text = "unknown flag " + bench::quote(word) + (meant.empty() ? "" : "; did you mean '" + meant + "'?");
  }
  return text + " (see `polhode " + (chosen.empty() ? "" : verb.get_name() + " ") + "--help`)";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Polhode: how well do integrators keep an attitude, and at what cost?", "polhode"};
  app.set_version_flag("--version", bench::version_text());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 ok, 1 an expectation failed, 2 usage, 3 nothing selected, 4 a run failed, 5 a bad file, "
      "130 interrupted.");
  int code = exit_ok;
  bench::add_commands(app, code);
  add_report(app);
  try {
    app.parse(argc, argv);
    return code;
  } catch (CLI::Success const& success) {  // --help, --version
    return app.exit(success);
  } catch (CLI::ParseError const& error) {
    return complain(exit_usage, explain(error, app));
  } catch (bench::UsageError const& error) {
    return complain(exit_usage, error.what());
  } catch (bench::NothingSelected const& error) {
    return complain(exit_nothing_selected, error.what());
  } catch (std::exception const& error) {  // files: suites, records, references, reports
    return complain(exit_bad_file, error.what());
  }
}
