// Mistakes at the command line and in files: each has its message, its exit code, and leaves nothing behind.
#include <sstream>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

struct Bad {
  std::string words;
  int code;
  std::string message;  ///< without "polhode: " and the newline
};

/// Runs every line in a folder that holds `files`, and expects that it changes nothing there.
void expect_complaints(std::vector<Bad> const& table, std::map<std::string, std::string> const& files = {}) {
  Folder folder;
  for (auto const& [name, text] : files) folder.write(name, text);
  auto const before = folder.contents();
  for (auto const& [words, code, message] : table) {
    Result const result = polhode(folder, words);
    EXPECT_EQ(result.err, "polhode: " + message + "\n") << words;
    EXPECT_EQ(result.code, code) << words;
    EXPECT_EQ(result.out, "") << words;
    EXPECT_EQ(folder.contents(), before) << words;
  }
}

/// The same beginning before each line's words.
std::vector<Bad> all_begin(std::string const& beginning, std::vector<Bad> table) {
  for (Bad& bad : table) bad.words = beginning + " " + bad.words;
  return table;
}

/// All verbs, as a message lists them: what stands under "Subcommands:" of the help.
std::string verbs() {
  std::string const help = polhode(Folder(), "--help").out;
  std::istringstream in(help.substr(help.find("Subcommands:")));
  std::string all;
  for (std::string line; std::getline(in, line) && !(line.empty() && !all.empty());) {
    if (!line.starts_with("  ") || line[2] == ' ') continue;
    all += (all.empty() ? "" : ", ") + line.substr(2, line.find(' ', 2) - 2);
  }
  return all;
}

std::string const of_simulate = " (see `polhode simulate --help`)";
std::string const of_run = " (see `polhode run --help`)";

// ---- Verbs, flags and words: exit code 2 ----------------------------------------------------------------------------

TEST(CliUsage, VerbsAndFlags) {
  expect_complaints({
      {"", 2, "no verb; choose from " + verbs() + " (see `polhode --help`)"},
      {"simulat free_body", 2, "unknown verb 'simulat'; did you mean 'simulate'? (see `polhode --help`)"},
      {"frobnicate", 2, "unknown verb 'frobnicate'; choose from " + verbs() + " (see `polhode --help`)"},
      {"--versoin", 2, "unknown flag '--versoin'; did you mean '--version'? (see `polhode --help`)"},
      {"-x list problems", 2, "unknown flag '-x' (see `polhode list --help`)"},
      {"list", 2, "WHAT is required (see `polhode list --help`)"},
      {"list integrator", 2, "unknown list 'integrator'; did you mean 'integrators'?"},
      {"list weather", 2, "unknown list 'weather'; choose from problems, formulations, integrators, policies, suites"},
      {"list problems --jsn", 2, "unknown flag '--jsn'; did you mean '--json'? (see `polhode list --help`)"},
      {"list problems free_body", 2, "unexpected argument 'free_body' (see `polhode list --help`)"},
      {"run defualt", 2, "unknown suite 'defualt'; did you mean 'default'?"},
      {"run default --frsh", 2, "unknown flag '--frsh'; did you mean '--fresh'?" + of_run},
      {"run default other", 2, "unexpected argument 'other'" + of_run},
      {"run default --out", 2, "--out: a value is missing" + of_run},
      {"run default --timeout soon", 2, "--timeout: 'soon' is not a number" + of_run},
      {"run default --timeout -1", 2, "timeout = -1: a limit is a finite number of seconds; 0 for none"},
      {"run default --timeout nan", 2, "timeout = nan: a limit is a finite number of seconds; 0 for none"},
      {"run default --threads 0", 2, "threads = 0: a whole number from 1 to 1024 is wanted"},
      {"run default --threads 1.5", 2, "threads = 1.5: a whole number from 1 to 1024 is wanted"},
      {"run default --threads 1e9", 2, "threads = 1000000000: a whole number from 1 to 1024 is wanted"},
      {"run default --filter (", 2,
       "--filter '(': not a regular expression: Mismatched '(' and ')' in regular expression"},
      {"run default --filter weather", 3, "--filter 'weather' matches no cell of suite 'default'"},
      {"run default --filter weather --dry-run", 3, "--filter 'weather' matches no cell of suite 'default'"},
      {"report", 2, "DIR is required (see `polhode report --help`)"},
      {"report . --otu x", 2, "unknown flag '--otu'; did you mean '--out'? (see `polhode report --help`)"},
      {"reference --variant case1", 2, "--variant, --set and --t-end need a PROBLEM"},
      {"run default --shard 3/2 --dry-run", 2, "--shard '3/2': write K/N, the K-th of N parts, K from 1 to N"},
      {"reference fre_body --out r", 2, "unknown problem 'fre_body'; did you mean 'free_body'?"},
      {"reference free_body --integrator rk4", 2, "unknown flag '--integrator' (see `polhode reference --help`)"},
      {"reference tether_capture --variant case1,case3 --out r", 2,
       "variant 'case1,case3': case1 and case3 exclude each other; give one"},
      {"reference free_body --t-end nan --out r", 2, "t_end = nan: a horizon is a positive finite number of seconds"},
      {"reference free_body --set inertia=1,1,3 --out r", 2,
       "free_body: parameter inertia: breaks the triangle inequality: no principal moment may exceed the sum of the "
       "other two"},
      {"reference tether_capture --variant coupled --out r", 2,
       "tether_capture: variant coupled ties the sample period to the step: needs fixed steps"},
  });
}

TEST(CliUsage, WordsOfSimulate) {
  expect_complaints(all_begin(
      "simulate",
      {
          {"", 2, "PROBLEM is required" + of_simulate},
          {"free_body", 2, "--integrator is required" + of_simulate},
          {"free_body --integrator", 2, "--integrator: a value is missing" + of_simulate},
          {"free_body --integrator rk4 --h 0.1 --h 0.2", 2, "--h is given more than once" + of_simulate},
          {"free_body --integrator rk4 --hh 0.1", 2, "unknown flag '--hh'; did you mean '--h'?" + of_simulate},
          {"free_body --integrator rk4 --h 0.1 pd_slew", 2, "unexpected argument 'pd_slew'" + of_simulate},
          {"fre_body --integrator rk4 --h 0.1", 2, "unknown problem 'fre_body'; did you mean 'free_body'?"},
          {"free_body --integrator gaus2 --h 0.1", 2, "unknown integrator 'gaus2'; did you mean 'gauss2'?"},
          {"free_body --integrator rk4 --h 0.1 --policy projct", 2, "unknown policy 'projct'; did you mean 'project'?"},
          {"free_body --integrator rk4 --h 0.1 --formulation quaternoin", 2,
           "unknown formulation 'quaternoin' of free_body; did you mean 'quaternion'?"},
          {"free_body --integrator rk4 --h 0.1 --variant case1", 2,
           "unknown variant 'case1' of free_body; there are none"},
          {"tether_capture --integrator rk4 --h 0.1 --variant case9", 2,
           "unknown variant 'case9' of tether_capture; did you mean 'case1'?"},
          {"tether_capture --integrator rk4 --h 0.1 --variant case1,g1,case2", 2,
           "variant 'case1,g1,case2': case1 and case2 exclude each other; give one"},
          {"tether_capture --integrator rk4 --h 0.1 --variant g1,g1", 2, "variant 'g1,g1': g1 is given twice"},
          {"tether_capture --integrator rk4 --h 0.1 --variant case1,", 2,
           "variant 'case1,': a word is missing beside a comma"},
      }));
}

// ---- Numbers --------------------------------------------------------------------------------------------------------

TEST(CliUsage, StepsAndTolerances) {
  std::string const step = ": a step size is a positive finite number of seconds";
  std::string const tolerance = ": a tolerance is a positive finite number";
  expect_complaints(
      all_begin("simulate free_body --integrator",
                {
                    {"rk4", 2, "give h (fixed steps) or rtol (adaptive)"},
                    {"rk4 --h fast", 2, "--h: 'fast' is not a number" + of_simulate},
                    {"rk4 --h 0.1s", 2, "--h: '0.1s' is not a number" + of_simulate},
                    {"rk4 --h 0x1p-3", 2, "--h: '0x1p-3' is not a number" + of_simulate},
                    {"rk4 --h ''", 2, "--h: '' is not a number" + of_simulate},
                    {"rk4 --h 1e999", 2, "--h: '1e999' is beyond the range of a double" + of_simulate},
                    {"rk4 --h nan", 2, "h = nan" + step},
                    {"rk4 --h inf", 2, "h = inf" + step},
                    {"rk4 --h -0.1", 2, "h = -0.1" + step},
                    {"rk4 --h 0", 2, "h = 0" + step},
                    {"rk4 --rtol 1e-6", 2, "rk4 has no error estimate: give h, not rtol"},
                    {"cvode_bdf --h 0.1", 2, "cvode_bdf chooses its own steps: give rtol (and atol), not h"},
                    {"dopri5 --h 0.1 --rtol 1e-6", 2, "give h or rtol, not both"},
                    {"dopri5 --h 0.1 --atol 1e-6", 2, "give h or rtol (and atol), not h and atol"},
                    {"dopri5 --atol 1e-6", 2, "atol without rtol: give both, or rtol alone"},
                    {"dopri5 --rtol 0", 2, "rtol = 0" + tolerance},
                    {"dopri5 --rtol -1e-6", 2, "rtol = -1e-06" + tolerance},
                    {"dopri5 --rtol 1e-6 --atol inf", 2, "atol = inf" + tolerance},
                }));
}

TEST(CliUsage, Times) {
  std::string const horizon = ": a horizon is a positive finite number of seconds";
  std::string const interval = ": an output interval is a positive finite number of seconds";
  std::string const ends = ": output times are ends of steps; give --every ";
  std::string const straddles =
      " s does not divide the sample period 0.1 s of tether_capture: a step must not "
      "straddle a sample; h = ";
  expect_complaints(all_begin(
      "simulate",
      {
          {"free_body --integrator rk4 --h 0.1 --t-end -1", 2, "t_end = -1" + horizon},
          {"free_body --integrator rk4 --h 0.1 --t-end 0", 2, "t_end = 0" + horizon},
          {"free_body --integrator rk4 --h 0.1 --t-end nan", 2, "t_end = nan" + horizon},
          {"free_body --integrator rk4 --h 0.1 --t-end later", 2, "--t-end: 'later' is not a number" + of_simulate},
          {"free_body --integrator rk4 --h 0.1 --every 0", 2, "every = 0" + interval},
          {"free_body --integrator rk4 --h 0.1 --every inf", 2, "every = inf" + interval},
          {"free_body --integrator rk4 --h 0.1 --every 0.25", 2,
           "outputs every 0.25 s are no multiple of h = 0.1 s" + ends + "0.3"},
          {"free_body --integrator rk4 --h 0.1 --every 0.05", 2,
           "outputs every 0.05 s are no multiple of h = 0.1 s" + ends + "0.1"},
          {"free_body --integrator rk4 --h 0.3", 2, "outputs every 0.5 s are no multiple of h = 0.3 s" + ends + "0.6"},
          {"free_body --integrator dopri5 --rtol 1e-6 --every 1e-12", 2,
           "outputs every 1e-12 s until 50 s are more than 10000000 rows; give --every 5e-06 or more"},
          {"tether_capture --integrator rk4 --h 0.03", 2, "h = 0.03" + straddles + "0.025 would be right"},
          {"tether_capture --integrator rk4 --h 0.2", 2, "h = 0.2" + straddles + "0.1 would be right"},
          {"tether_capture --integrator rk4 --h 0.1 --set sample_period=0.15", 2,
           "h = 0.1 s does not divide the sample period 0.15 s of tether_capture: a step must not straddle a sample; "
           "h = 0.075 would be right"},
      }));
}

TEST(CliUsage, Parameters) {
  std::string const triangle =
      "free_body: parameter inertia: breaks the triangle inequality: no principal moment may exceed the sum of the "
      "other two";
  std::string const positive =
      "free_body: parameter inertia: principal moments of inertia must be greater than 0 kg m^2";
  expect_complaints(
      all_begin("simulate free_body --integrator rk4 --h 0.1 --set",
                {
                    {"inertai=1,2,3", 2, "unknown parameter 'inertai' of free_body; did you mean 'inertia'?"},
                    {"k_pe=1", 2, "unknown parameter 'k_pe' of free_body; choose from inertia, q0, omega0"},
                    {"inertia", 2, "--set 'inertia': write NAME=NUMBER[,NUMBER...]"},
                    {"=3", 2, "--set '=3': write NAME=NUMBER[,NUMBER...]"},
                    {"inertia=", 2, "parameter inertia: no value; give at least one number"},
                    {"inertia=1,,2", 2, "--set 'inertia=1,,2': '' is not a number"},
                    {"inertia=1,x,2", 2, "--set 'inertia=1,x,2': 'x' is not a number"},
                    {"inertia=1,1,1e999", 2, "--set 'inertia=1,1,1e999': '1e999' is beyond the range of a double"},
                    {"inertia=nan,1,1", 2, "parameter inertia: nan is not a finite number"},
                    {"omega0=1,-inf,1", 2, "parameter omega0: -inf is not a finite number"},
                    {"inertia=1,2", 2, "free_body: parameter inertia: takes 3 or 6 number(s), not 2"},
                    {"q0=0,0,1", 2, "free_body: parameter q0: takes 4 number(s), not 3"},
                    {"inertia=-1,1,1", 2, positive},
                    {"inertia=1,1,0", 2, positive},
                    {"inertia=1,1,1,2,0,0", 2, positive},
                    {"inertia=1,1,3", 2, triangle},
                    {"inertia=1,1,1,0.9,0,0", 2, triangle},
                    {"q0=1,1,1,1", 2,
                     "free_body: parameter q0: |q|^2 must be within 2% of 1 (it is then normalised), not 4.000000"},
                    {"inertia=1,1,1 --set inertia=2,2,2", 2, "--set 'inertia=2,2,2': 'inertia' is given twice"},
                }));
  expect_complaints({
      {"simulate pd_slew --integrator rk4 --h 0.1 --set k_p=-1", 2, "pd_slew: parameter k_p: must not be negative"},
      {"simulate tether_capture --integrator rk4 --h 0.1 --set sample_period=0", 2,
       "tether_capture: parameter sample_period: must be greater than 0 s"},
  });
}

TEST(CliUsage, CombinationsThatAreRefused) {
  expect_complaints(all_begin(
      "simulate",
      {
          {"free_body --integrator rk4 --h 0.1 --formulation s3", 2, "rk4 on s3: needs flat coordinates"},
          {"free_body --integrator cf4 --h 0.1", 2,
           "cf4 on quaternion: needs a rotation group (formulation s3 or so3)"},
          {"free_body --integrator cvode_bdf --rtol 1e-6 --policy project", 2,
           "cvode_bdf on quaternion: projection would break the multistep history that the next step extrapolates"},
          {"tether_capture --variant coupled --integrator dopri5 --rtol 1e-6", 2,
           "tether_capture: variant coupled ties the sample period to the step: needs fixed steps"},
      }));
}

// ---- Files: exit code 5 ---------------------------------------------------------------------------------------------

std::string sweep(std::string const& lines) {
  return "name = 'mine'\n[[sweep]]\nformulation = 'quaternion'\n" + lines;
}

TEST(CliFiles, Suites) {
  std::map<std::string, std::string> const files{
      {"folder/a.txt", ""},
      {"toml.toml", "name = 'mine'\nh = \n"},
      {"key.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nhh = 0.1\n")},
      {"type.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nh = '0.1'\n")},
      {"word.toml", sweep("problem = 'free_body'\nintegrator = ['rk4',\n'gaus2']\nh = 0.1\n")},
      {"variant.toml", sweep("problem = 'tether_capture'\nvariant = 'case1,case2'\nintegrator = 'rk4'\nh = 0.1\n")},
      {"step.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nh = -0.1\n")},
      {"rule.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nh = 0.1\nset = [{ inertia = [1, 1, 3] }]\n")},
      {"straddle.toml", sweep("problem = 'tether_capture'\nintegrator = 'rk4'\nh = [0.05, 0.03]\n")},
      {"coupled.toml", sweep("problem = 'tether_capture'\nvariant = 'coupled'\nintegrator = 'dopri5'\nrtol = 1e-6\n")},
      {"none.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nh = 0.1\n[[exclude]]\nintegrator = 'rk4'\n")},
      {"good.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nh = 0.1\n")},
  };
  expect_complaints(
      {
          {"run missing.toml", 5, "missing.toml: cannot be read: No such file or directory"},
          {"run ./missing", 5, "./missing: cannot be read: No such file or directory"},
          {"run folder", 5, "folder: is a directory; give a file"},
          {"run /dev/zero", 5, "/dev/zero: is a device; give a file"},
          {"run toml.toml", 5, "toml.toml:2: not valid TOML: missing value after key-value separator '='"},
          {"run key.toml", 5, "key.toml:6: unknown key 'hh' in [[sweep]]; did you mean 'h'?"},
          {"run type.toml", 5, "type.toml:6: h: number expected, string found"},
          {"run word.toml", 5, "word.toml:6: unknown integrator 'gaus2'; did you mean 'gauss2'?"},
          {"run variant.toml", 5,
           "variant.toml:5: variant 'case1,case2': case1 and case2 exclude each other; give one"},
          {"run step.toml", 5, "step.toml:6: h = -0.1: a step size is a positive finite number of seconds"},
          {"run rule.toml", 5,
           "rule.toml: suite 'mine': free_body: parameter inertia: breaks the triangle inequality: no principal moment "
           "may "
           "exceed the sum of the other two"},
          {"run straddle.toml", 5,
           "straddle.toml: suite 'mine': h = 0.03 s does not divide the sample period 0.1 s of tether_capture: a step "
           "must "
           "not straddle a sample; h = 0.025 would be right"},
          {"run coupled.toml", 5,
           "coupled.toml: suite 'mine': tether_capture: variant coupled ties the sample period to the step: needs "
           "fixed "
           "steps"},
          {"run none.toml", 3, "suite 'mine' has no cells"},
          {"run good.toml --out good.toml", 5, "good.toml: Not a directory"},
          {"run good.toml --out good.toml/results", 5, "good.toml/results: Not a directory"},
      },
      files);
}

TEST(CliFiles, Unreadable) {
  if (::geteuid() == 0) GTEST_SKIP() << "root reads everything";
  Folder folder;
  folder.write("mine.toml", "");
  fs::permissions(folder.path / "mine.toml", fs::perms::none);
  Result const result = polhode(folder, "run mine.toml");
  EXPECT_EQ(result.err, "polhode: mine.toml: cannot be read: Permission denied\n");
  EXPECT_EQ(result.code, 5);
}

TEST(CliFiles, ResultFolders) {
  std::string const meta = "{\"schema\":1,\"kind\":\"meta\",\"build\":\"b\"}\n";
  std::string const begin = "{\"schema\":1,\"kind\":\"begin\",\"cell\":\"0123456789abcdef\",\"build\":\"b\"}\n";
  std::map<std::string, std::string> const files{
      {"empty/notes.txt", "no results\n"},
      {"damaged/a.jsonl", meta + begin + "{\"schema\":1,\"ki\n" + begin},
      {"headless/a.jsonl", begin},
      {"newer/a.jsonl", "{\"schema\":2,\"kind\":\"meta\",\"build\":\"b\"}\n"},
      {"text", "no results\n"},
      {"good.toml", sweep("problem = 'free_body'\nintegrator = 'rk4'\nh = 0.1\n")},
  };
  expect_complaints(
      {
          {"report missing", 5, "missing: no such file or folder"},
          {"report empty", 5, "empty: holds no results; give a folder that `polhode run` or `polhode ensemble` wrote"},
          {"report text", 5, "text:1: not JSON (byte 2); a line must be one JSON object"},
          {"report damaged", 5, "damaged/a.jsonl:3: not JSON (byte 16); a line must be one JSON object"},
          {"report headless", 5, "headless/a.jsonl:1: kind: \"begin\"; the first line, and no other, must be a meta"},
          {"report newer", 5, "newer/a.jsonl:1: schema: 2; must be 1"},
          {"run good.toml --out damaged", 5, "damaged/a.jsonl:3: not JSON (byte 16); a line must be one JSON object"},
      },
      files);
}

TEST(CliFiles, PlacesThatCannotBeWritten) {
  expect_complaints(
      {
          {"simulate free_body --integrator rk4 --h 0.1 --out missing/a.csv", 5,
           "missing/a.csv: cannot be written: No such file or directory"},
          {"simulate free_body --integrator rk4 --h 0.1 --out .", 5, ".: cannot be written: Is a directory"},
          {"reference free_body --t-end 1 --out file", 5, "file: cannot be made: Not a directory"},
          {"reference free_body --t-end 1 --out file/x", 5, "file/x: cannot be made: Not a directory"},
      },
      {{"file", ""}});
}

TEST(CliFiles, AFullDiskIsNoSuccess) {
  Folder folder;
  for (std::string const words : {"list problems", "list integrators --json", "--version", "run --help",
                                  "simulate free_body --integrator rk4 --h 0.1"}) {
    Result const result = Process(folder.path, split(words), {}, "/dev/full").finish();
    EXPECT_EQ(result.err, "polhode: standard output: cannot be written: No space left on device\n") << words;
    EXPECT_EQ(result.code, 5) << words;
  }
}

}  // namespace
}  // namespace polhode::cli
