#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bench/input/suite.hpp"
#include "tests/bench/suite_file.hpp"
#include "tests/support/complaint.hpp"

namespace polhode::bench {
namespace {

using namespace test;

/// The SuiteError for a text, with "FILE" for the file's name; "" if there is none.
std::string complaint(std::string const& text) {
  TemporaryFile const file(text);
  auto message = polhode::test::complaint_of<SuiteError>([&] { read_suite(file.path, small_vocabulary()); });
  auto const name = file.path.string();
  auto const at = message.find(name);
  return at == std::string::npos ? message : message.replace(at, name.size(), "FILE");
}

/// Line 6 of a bad suite: the key of an expectation of all cells.
std::string const expect = "[[expect]]\nselect = {}\n";

struct Bad {
  std::string text, message;
};

void expect_complaints(std::vector<Bad> const& table) {
  for (auto const& [text, message] : table) {
    EXPECT_EQ(complaint(text), message) << "for\n" << text.substr(0, 400);
  }
}

TEST(BadSuite, NotToml) {
  std::string const deep(200, '[');
  std::string dotted = "a";
  for (int i = 0; i < 200; ++i) dotted += ".a";
  expect_complaints({
      {"name = \n", "FILE:1: not valid TOML: missing value after key-value separator '='"},
      {"name = 'a'\nname = 'b'\n", "FILE:2: not valid TOML: value (\"name\") already exists"},
      {"name\n", "FILE:1: not valid TOML: missing key-value separator `=`"},
      {"a = 1\n\nb = tru\n", "FILE:3: not valid TOML: the next token is not a boolean"},
      {"a = 0x\n", "FILE:1: not valid TOML: the next token is not an integer"},
      {"a = [1,\n2,,3]\n", "FILE:2: not valid TOML: value having invalid format appeared in an array"},
      {"a = \"abc\n", "FILE:1: not valid TOML: the next token is not a valid string"},
      {"# a\n# \xff\n", "FILE:2: not valid TOML: not UTF-8"},
      {"\n[\v\v", "FILE:2: not valid TOML: an invalid key appeared"},
      {"a=\u01e8", "FILE:1: not valid TOML: bad format: unknown value appeared"},
      {"a = " + deep, "FILE:1: not valid TOML: nested too deeply"},
      {"\n" + dotted + " = 1", "FILE:2: not valid TOML: nested too deeply"},
      {"[" + dotted + "]", "FILE:1: not valid TOML: nested too deeply"},
      {std::string("\0\0", 2), "FILE:1: not valid TOML: an invalid key appeared"},
  });
}

TEST(BadSuite, TopLevel) {
  expect_complaints({
      {"", "FILE:1: the suite has no 'name'; give e.g. name = \"mine\""},
      {name_line, "FILE:1: no [[sweep]]; a suite has at least one"},
      {name_line + "sweep = []\n", "FILE:1: no [[sweep]]; a suite has at least one"},
      {"name = ''\n", "FILE:1: name: empty; give e.g. name = \"mine\""},
      {"name = 3\n", "FILE:1: name: string expected, integer found"},
      {good + "[[sweeps]]\n", "FILE:6: unknown key 'sweeps' in the suite; did you mean 'sweep'?"},
      {name_line + "[sweep]\n", "FILE:2: sweep: write a table that is headed [[sweep]]"},
      {name_line + "sweep = [1]\n", "FILE:2: sweep: write a table that is headed [[sweep]]"},
      {good + "[timing]\nenabled = 1\n", "FILE:7: enabled: true or false expected, integer found"},
      {good + "[timing]\nmin_time = 0\n", "FILE:7: min_time = 0: must be positive"},
      {good + "[timing]\nrepetitions = 2.5\n", "FILE:7: repetitions: whole number expected, float found"},
      {good + "[timing]\nrepetitions = 0\n", "FILE:7: repetitions = 0: a whole number from 1 to 10000 is wanted"},
      {good + "[timing]\nrepetition = 5\n",
       "FILE:7: unknown key 'repetition' in [timing]; did you mean 'repetitions'?"},
      {"timing = 3\n" + good, "FILE:1: [timing]: table expected, integer found"},
  });
}

TEST(BadSuite, Words) {
  expect_complaints({
      {sweep("problem = 'free_body'\nintegrater = 'rk4'\nh = 0.1\n"),
       "FILE:4: unknown key 'integrater' in [[sweep]]; did you mean 'integrator'?"},
      {sweep("integrator = 'rk4'\nh = 0.1\n"),
       "FILE:2: [[sweep]] has no 'problem'; give e.g. problem = [\"free_body\"]"},
      {sweep("problem = 'free_body'\nh = 0.1\n"),
       "FILE:2: [[sweep]] has no 'integrator'; give e.g. integrator = [\"rk4\"]"},
      {sweep("problem = 'fre_body'\nintegrator = 'rk4'\nh = 0.1\n"),
       "FILE:3: unknown problem 'fre_body'; did you mean 'free_body'?"},
      {sweep("problem = 'free_body'\nintegrator = ['rk4',\n 'gaus2']\nh = 0.1\n"),
       "FILE:5: unknown integrator 'gaus2'; did you mean 'gauss2'?"},
      {sweep("problem = 'free_body'\nintegrator = 'x*'\nh = 0.1\n"), "FILE:4: integrator: no name matches x*"},
      {sweep("problem = []\nintegrator = 'rk4'\nh = 0.1\n"),
       "FILE:3: problem: empty list; give at least one value or leave the key out"},
      {sweep("problem = [['free_body']]\nintegrator = 'rk4'\nh = 0.1\n"),
       "FILE:3: problem: string expected, array found"},
      {good + "problem = 'a'\n", "FILE:6: not valid TOML: value (\"problem\") already exists"},
      {good + "policy = 'projct'\n", "FILE:6: unknown policy 'projct'; did you mean 'project'?"},
      {good + "formulation = ['s3', 'so3']\n", "FILE:6: unknown formulation 'so3' of free_body; did you mean 's3'?"},
      {good + "variant = 'case1'\n", "FILE:6: unknown variant 'case1' of free_body; there are none"},
      {sweep("problem = 'tether_capture'\nvariant = 'case1,case2'\nintegrator = 'rk4'\nh = 0.1\n"),
       "FILE:4: variant 'case1,case2': case1 and case2 exclude each other; give one"},
      {good + "set = [{ inertai = 1 }]\n", "FILE:6: unknown parameter 'inertai' of free_body; did you mean 'inertia'?"},
      {good + "set = [{}, { inertia = [1, nan, 2] }]\n", "FILE:6: inertia = nan: not a finite number"},
      {good + "set = [{ inertia = [] }]\n",
       "FILE:6: inertia: empty list; give at least one value or leave the key out"},
      {good + "set = [{ inertia = 'wide' }]\n", "FILE:6: inertia: number expected, string found"},
      {good + "set = 'inertia'\n", "FILE:6: set: table such as { inertia = [0.6, 0.8, 1.0] } expected, string found"},
      {good + "seed = 1.5\n", "FILE:6: seed: whole number expected, float found"},
      {good + "seed = 99999999999999999999\n",
       "FILE:6: seed = 9223372036854775807: a whole number from -9223372036854775806 to 9223372036854775806 is wanted"},
      {good + "tags = ['']\n", "FILE:6: tags: a tag must not be empty"},
      {good + "tags = [1979-05-27]\n", "FILE:6: tags: string expected, local_date found"},
  });
}

TEST(BadSuite, Controls) {
  auto const with = [](std::string const& lines) {
    return sweep("problem = 'free_body'\nintegrator = ['rk4', 'gauss2']\n" + lines);
  };
  expect_complaints({
      {with(""), "FILE:2: [[sweep]]: give h (fixed steps) or rtol (adaptive)"},
      {with("h = -0.1\n"), "FILE:5: h = -0.1: a step size is a positive finite number of seconds"},
      {with("h = [0.1, 0]\n"), "FILE:5: h = 0: a step size is a positive finite number of seconds"},
      {with("h = inf\n"), "FILE:5: h = inf: not a finite number"},
      {with("h = '0.1'\n"), "FILE:5: h: number expected, string found"},
      {with("h = true\n"), "FILE:5: h: number expected, boolean found"},
      {with("h = []\n"), "FILE:5: h: empty list; give at least one value or leave the key out"},
      {with("h = 0.1\nt_end = -5\n"), "FILE:6: t_end = -5: a horizon is a positive finite number of seconds"},
      {with("h = 0.1\nt_end = { logspace = [1, 2], count = 2 }\n"), "FILE:6: t_end: number expected, table found"},
      {with("h = { logspace = [0.1, 0.2] }\n"), "FILE:5: h = { logspace, count } has no 'count'; give e.g. count = 4"},
      {with("h = { count = 4 }\n"),
       "FILE:5: h = { logspace, count } has no 'logspace'; give e.g. logspace = [0.01, 0.1]"},
      {with("h = { logspace = [0.1, 0.2], cuont = 4 }\n"),
       "FILE:5: unknown key 'cuont' in h = { logspace, count }; did you mean 'count'?"},
      {with("h = { logspace = [0.1, 0.2], count = 1 }\n"),
       "FILE:5: count = 1: a whole number from 2 to 10000 is wanted"},
      {with("h = { logspace = [0.1, 0.2], count = 10001 }\n"),
       "FILE:5: count = 10001: a whole number from 2 to 10000 is wanted"},
      {with("h = { logspace = [0, 0.2], count = 3 }\n"), "FILE:5: logspace = [0, 0.2]: both ends must be positive"},
      {with("h = { logspace = [0.1], count = 3 }\n"), "FILE:5: logspace: two numbers expected, as in [0.01, 0.1]"},
      {with("h = { logspace = [0.1, 1e999], count = 3 }\n"),
       "FILE:5: logspace = 1.7976931348623157e+308: not a finite number"},
      {with("atol = 1e-9\nh = 0.1\n"), "FILE:5: atol without rtol: give both, or rtol alone"},
      {with("h = 0.1\nrtol = 1e-6\n"), "FILE:6: rk4 has no error estimate: give h, not rtol"},
      {sweep("problem = 'free_body'\nintegrator = 'cvode_bdf'\nh = 0.1\n"),
       "FILE:5: cvode_bdf chooses its own steps: give rtol (and atol), not h"},
  });
}

TEST(BadSuite, TooManyCells) {
  std::string const h = "h = { logspace = [0.001, 0.1], count = 10000 }\n";
  std::string const rtol = "rtol = { logspace = [1e-12, 1e-2], count = 10000 }\n";
  std::string const atol = "atol = { logspace = [1e-12, 1e-2], count = 10000 }\n";
  std::string seeds = "seed = [1";
  for (int i = 2; i <= 60; ++i) seeds += ", " + std::to_string(i);
  seeds += "]\n";
  std::string const one = "[[sweep]]\nproblem = 'free_body'\nintegrator = 'rk4'\n" + h + seeds;
  std::string const message = "more than 1000000 cells; shorten the axes or split the suite";
  EXPECT_EQ(complaint(name_line + one), "FILE:2: " + message);
  EXPECT_EQ(complaint(sweep("problem = 'free_body'\nintegrator = 'dopri5'\n" + rtol + atol)), "FILE:2: " + message);
  // Each sweep is small enough, with one formulation of the two; both together are not.
  std::string const half = one + "formulation = 's3'\n";
  EXPECT_EQ(complaint(name_line + half + half), "FILE:8: " + message);
}

TEST(BadSuite, Selectors) {
  expect_complaints({
      {good + "[[exclude]]\n", "FILE:6: an empty [[exclude]] drops every cell; give e.g. integrator = \"rk4\""},
      {good + "[exclude]\nh = 0.1\n", "FILE:6: exclude: write a table that is headed [[exclude]]"},
      {good + "[[exclude]]\nproblems = 'free_body'\n",
       "FILE:7: unknown key 'problems' in [[exclude]]; did you mean 'problem'?"},
      {good + "[[exclude]]\nintegrator = 'rk5'\n", "FILE:7: unknown integrator 'rk5'; did you mean 'rk4'?"},
      {good + "[[exclude]]\nvariant = 'g1,case9'\n", "FILE:7: unknown variant 'case9'; did you mean 'case1'?"},
      {good + "tags = 'quick'\n[[exclude]]\ntag = 'qiuck'\n", "FILE:8: unknown tag 'qiuck'; did you mean 'quick'?"},
      {good + "[[exclude]]\nh = 'small'\n", "FILE:7: h: 'small' is neither a number nor a glob"},
      {good + "[[exclude]]\nh = [0.1]\n", "FILE:7: h: string expected, array found"},
      {good + "[[exclude]]\nh = nan\n", "FILE:7: h = nan: not a finite number"},
      {good + "[[exclude]]\nnorm_drift = 3\n",
       "FILE:7: unknown key 'norm_drift' in [[exclude]]; choose from atol, formulation, h, integrator, policy, "
       "problem, "
       "rtol, seed, set, t_end, tag, variant"},
  });
}

TEST(BadSuite, Expectations) {
  expect_complaints({
      {good + "[[expect]]\nstatus = { is = 'ok' }\n",
       "FILE:6: [[expect]] has no 'select'; give e.g. select = { integrator = \"rk4\" }, or select = {} for every "
       "cell"},
      {good + "[[expect]]\nselect = 'rk4'\n", "FILE:7: select: table expected, string found"},
      {good + "[[expect]]\nselect = { integrater = 'rk4' }\n",
       "FILE:7: unknown key 'integrater' in select; did you mean 'integrator'?"},
      {good + expect, "FILE:6: [[expect]] bounds nothing; give e.g. norm_drift = { max = 1e-9 }"},
      {good + expect + "norm_drft = { max = 1 }\n",
       "FILE:8: unknown key 'norm_drft' in [[expect]]; did you mean 'norm_drift'?"},
      {good + expect + "norm_drift = { maximum = 1 }\n",
       "FILE:8: unknown key 'maximum' in norm_drift; choose from min, max, is, golden, rel, abs, digits"},
      {good + expect + "norm_drift = { mx = 1 }\n", "FILE:8: unknown key 'mx' in norm_drift; did you mean 'max'?"},
      {good + expect + "norm_drift = 1e-9\n", "FILE:8: norm_drift: table such as { max = 1e-9 } expected, float found"},
      {good + expect + "status = 'ok'\n", "FILE:8: status: table such as { is = \"ok\" } expected, string found"},
      {good + expect + "status = { max = 1 }\n", "FILE:8: unknown key 'max' in status; choose from is, golden"},
      {good + expect + "norm_drift = {}\n", "FILE:8: norm_drift is not bounded; give e.g. { max = 1e-9 }"},
      {good + expect + "norm_drift = { max = '1' }\n", "FILE:8: norm_drift.max: number expected, string found"},
      {good + expect + "norm_drift = { max = inf }\n", "FILE:8: norm_drift.max = inf: not a finite number"},
      {good + expect + "norm_drift = { min = 2, max = 1 }\n", "FILE:8: norm_drift: min = 2 is above max = 1"},
      {good + expect + "steps = { golden = 'yes' }\n", "FILE:8: steps.golden: true or false expected, string found"},
      {good + expect + "steps = { rel = 0.02 }\n", "FILE:8: steps: 'rel', 'abs' and 'digits' need golden = true"},
      {good + expect + "steps = { golden = true, rel = -1 }\n", "FILE:8: steps.rel = -1: must not be negative"},
      {good + expect + "steps = { nominal = true }\n",
       "FILE:8: unknown key 'nominal' in steps; choose from min, max, is, golden, rel, abs, digits"},
      {good + expect + "order = { within = 0.2 }\n", "FILE:8: order: 'within' needs nominal = true"},
      {good + expect + "cpu_time_s = { max = 1 }\n", "FILE:8: cpu_time_s: seconds are never gated"},
      {good + expect + "steps = { is = 3 }\nmin_cells = 0\n",
       "FILE:9: min_cells = 0: a whole number from 1 to 1000000 is wanted"},
      {good + expect + "steps = { is = 3 }\nxfail = true\n", "FILE:9: xfail: string expected, boolean found"},
      {good + expect + "steps = { is = 3 }\nxfail = ''\n", "FILE:9: xfail: empty; say why the expectation fails"},
  });
}

TEST(BadSuite, NoSuchFile) {
  auto const folder = std::filesystem::temp_directory_path();
  auto const missing = folder / "polhode_no_such_suite.toml";
  auto const message_of = [](std::filesystem::path const& file) -> std::string {
    try {
      read_suite(file, small_vocabulary());
    } catch (SuiteError const& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message_of(missing), missing.string() + ": cannot be read: No such file or directory");
  EXPECT_EQ(message_of(folder), folder.string() + ": is a directory; give a file");
  EXPECT_EQ(message_of("/dev/zero"), "/dev/zero: is a device; give a file");
}

}  // namespace
}  // namespace polhode::bench
