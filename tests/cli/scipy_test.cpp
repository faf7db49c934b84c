// Trajectories made with SciPy are scored as what they are. Their errors are computed here once more, in two ways that
// share nothing with `import`: from the decimal digits of the certified reference, and by SciPy against a much finer
// solution of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Json = nlohmann::json;
using State = std::vector<long double>;  ///< q1 ... q4, wx, wy, wz
fs::path const source = POLHODE_SOURCE_DIR;

Json score(fs::path const& folder, std::string const& words) {
  Result const result = Process(folder, split("import " + words + " --json")).finish();
  EXPECT_EQ(result.code, 0) << words << "\n" << result.err;
  return Json::parse(result.out, nullptr, false);
}

// ---- Against the digits of the reference
// -----------------------------------------------------------------------------

/// The states of the certified reference of that subject, by time [s].
std::map<double, State> reference_states(std::string const& subject) {
  for (auto const& entry : fs::directory_iterator(source / "results/reference")) {
    Json const json = Json::parse(text_of(entry.path()));
    if (json.at("subject") != subject) continue;
    std::map<double, State> states;
    for (Json const& row : json.at("states"))
      for (std::string const digits : row.at("decimal")) states[row.at("t")].push_back(std::stold(digits));
    return states;
  }
  return {};
}

std::map<double, State> rows_of(fs::path const& csv) {
  std::map<double, State> rows;
  std::istringstream in(text_of(csv));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "t,q1,q2,q3,q4,wx,wy,wz");
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    State row;
    for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stold(field));
    rows[double(row.at(0))] = State(row.begin() + 1, row.end());
  }
  return rows;
}

/// 2 atan2(|v|, |s|) of p^-1 q, scalar last.
long double angle(State const& p, State const& q) {
  long double const v[] = {p[3] * q[0] - q[3] * p[0] - (p[1] * q[2] - p[2] * q[1]),
                           p[3] * q[1] - q[3] * p[1] - (p[2] * q[0] - p[0] * q[2]),
                           p[3] * q[2] - q[3] * p[2] - (p[0] * q[1] - p[1] * q[0])};
  long double const s = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
  return 2 * std::atan2(std::hypot(v[0], v[1], v[2]), std::fabs(s));
}

TEST(CliScipy, ErrorsAgreeWithTheReferencesDigits) {
  auto const exact = reference_states("problem=free_body;variant=;t_end=50;seed=1");
  ASSERT_EQ(exact.size(), 51U);
  for (std::string const method : {"RK45", "DOP853"}) {
    fs::path const csv = source / "tests/scipy" / (method + ".csv");
    auto const rows = rows_of(csv);
    ASSERT_EQ(rows.size(), exact.size());
    long double worst = 0, last = 0, rate = 0, fastest = 0;
    for (auto const& [t, p] : exact) {
      State const& q = rows.at(t);
      last = angle(p, q);
      worst = std::max(worst, last);
      rate = std::max(rate, std::hypot(q[4] - p[4], q[5] - p[5], q[6] - p[6]));
      fastest = std::max(fastest, std::hypot(p[4], p[5], p[6]));
    }
    EXPECT_GT(worst, method == "RK45" ? 1e-7 : 1e-9) << "an error to be found";
    Json const json = score(source, csv.string() + " --problem free_body");
    EXPECT_EQ(json.at("points"), 51);
    EXPECT_NEAR(json.at("attitude_error_max"), double(worst), 1e-9 * double(worst)) << method;
    EXPECT_NEAR(json.at("attitude_error_end"), double(last), 1e-9 * double(last)) << method;
    // `import` knows the greatest rate between the states, too.
    EXPECT_NEAR(json.at("rate_error_max"), double(rate / fastest), 0.01 * double(rate / fastest)) << method;
  }
}

// ---- Against SciPy itself
// --------------------------------------------------------------------------------------------

/// A Python that has SciPy: the system's, or that of the path. Empty if there is none.
std::string python_with_scipy() {
  for (std::string const python : {"/usr/bin/python3", "python3"})
    if (std::system((python + " -c 'import scipy.integrate' >/dev/null 2>&1").c_str()) == 0) return python;
  return "";
}

TEST(CliScipy, ItsErrorsAreTheOnesItHas) {
  std::string const python = python_with_scipy();
  if (python.empty()) GTEST_SKIP() << "no python3 with SciPy (Debian: python3-scipy)";
  Folder folder;
  Json const problems = Json::parse(polhode(folder, "list problems --json").out);
  std::map<std::string, Json> defaults;
  for (Json const& problem : problems)
    if (problem.at("name") == "free_body")
      for (Json const& parameter : problem.at("parameters")) defaults[parameter.at("name")] = parameter.at("default");
  std::string const script = POLHODE_SOURCE_DIR "/tests/scipy/free_body.py";
  std::string const data = Json{defaults.at("inertia"), defaults.at("q0"), defaults.at("omega0")}.dump();
  ASSERT_EQ(
      std::system(("cd " + folder.path.string() + " && " + python + " " + script + " '" + data + "' 401").c_str()), 0);
  Json const expected = Json::parse(text_of(folder.path / "expected.json"));
  for (auto const& [method, errors] : expected.items()) {
    Json const json = score(folder.path, method + ".csv --problem free_body");
    EXPECT_EQ(json.at("status"), "ok");
    EXPECT_EQ(json.at("points"), 401);
    for (auto const& [key, error] : errors.items()) {
      double const theirs = error, ours = json.at(key);
      EXPECT_GT(theirs, 1e-12) << method << " " << key << ": too small to compare";
      EXPECT_NEAR(ours, theirs, 0.01 * theirs) << method << " " << key;
    }
  }
  EXPECT_GT(expected.at("RK45").at("attitude_error_max"), expected.at("DOP853").at("attitude_error_max"));
}

}  // namespace
}  // namespace polhode::cli
