// What the command prints and writes when it is used as it should be: help, lists, trajectories, references.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "results/record.hpp"
#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Json = nlohmann::json;

/// The output of a command that ends well and says nothing else.
std::string output_of(Folder const& folder, std::string const& words, Words const& environment = {}) {
  Result const result = polhode(folder, words, environment);
  EXPECT_EQ(result.code, 0) << words << "\n" << result.err;
  EXPECT_EQ(result.err, "") << words;
  return result.out;
}

TEST(Cli, HelpOfEveryVerb) {
  Folder const folder;
  std::string const all = output_of(folder, "--help");
  EXPECT_NE(all.find("Exit codes: 0 ok, 1 an expectation failed, 2 usage, 3 nothing selected"), std::string::npos);
  std::map<std::string, Words> const flags{
      {"list", {"WHAT", "--json"}},
      {"run", {"SUITE", "--out DIR", "--filter", "--fresh", "--retry-failed", "--dry-run", "--timeout", "--threads"}},
      {"simulate",
       {"PROBLEM", "--variant", "--formulation", "--integrator", "--policy", "--h ", "--rtol", "--atol", "--t-end",
        "--every", "--set NAME=VALUE", "--out FILE", "--plot FILE"}},
      {"compare", {"A", "B", "--out FILE", "--html FILE", "--json FILE", "--format", "--fail-on-regression"}},
      {"reference", {"PROBLEM", "--variant", "--t-end", "--set NAME=VALUE", "--out DIR"}},
      {"report", {"DIR", "--out DIR"}}};
  for (auto const& [verb, words] : flags) {
    EXPECT_NE(all.find("\n  " + verb + " "), std::string::npos) << verb;
    std::string const help = output_of(folder, verb + " --help");
    EXPECT_NE(help.find("Usage: polhode " + verb), std::string::npos) << help;
    for (std::string const& word : words) EXPECT_NE(help.find(word), std::string::npos) << verb << ": " << word;
    EXPECT_EQ(output_of(folder, verb + " -h"), help);
  }
  EXPECT_TRUE(folder.contents().empty());
}

TEST(Cli, VersionNamesTheBuild) {
  std::string const text = output_of(Folder(), "--version");
  EXPECT_EQ(text.rfind("polhode ", 0), 0U) << text;
  for (std::string const word : {"eigen ", "boost ", "Licence: MIT"})
    EXPECT_NE(text.find(word), std::string::npos) << text;
}

// ---- list -----------------------------------------------------------------------------------------------------------

std::set<std::string> const kept_things{"norm", "energy", "momentum", "momentum_direction", "symplectic", "symmetric"};
std::set<std::string> const families{"explicit_rk", "gauss", "lie_group", "rigid_body",
                                     "splitting",   "exact", "taylor",    "library"};
std::set<std::string> const all_needs{"flat", "group", "free_body", "none"};

TEST(CliList, IntegratorsAsJson) {
  Json const list = Json::parse(output_of(Folder(), "list integrators --json"));
  std::map<std::string, Json> by_name;
  for (Json const& entry : list) {
    std::string const name = entry.at("name");
    EXPECT_TRUE(by_name.emplace(name, entry).second) << name;
    EXPECT_TRUE(families.contains(entry.at("family"))) << name;
    EXPECT_TRUE(all_needs.contains(entry.at("needs"))) << name;
    EXPECT_TRUE(entry.at("order").is_null() || entry.at("order") > 0) << name;
    EXPECT_TRUE(entry.at("adaptive_only").is_boolean() && entry.at("rival").is_boolean()) << name;
    EXPECT_FALSE(entry.at("source").get<std::string>().empty()) << name;
    for (Json const& kept : entry.at("preserves")) EXPECT_TRUE(kept_things.contains(kept)) << name << kept;
  }
  EXPECT_EQ(by_name.at("rk4").at("order"), 4);
  EXPECT_EQ(by_name.at("gauss3").at("order"), 6);
  EXPECT_EQ(by_name.at("gauss2_tol6").at("order"), nullptr);  // a foil
  EXPECT_EQ(by_name.at("cf4").at("needs"), "group");
  EXPECT_EQ(by_name.at("cf4").at("needs_problem"), nullptr);
  EXPECT_EQ(by_name.at("split_strang").at("needs_problem"), "rigid_body");
  EXPECT_EQ(by_name.at("rattle").at("needs_problem"), "constraint");
  EXPECT_EQ(by_name.at("magnus4").at("needs_problem"), "prescribed_rates");
  EXPECT_EQ(by_name.at("cvode_bdf").at("order"), nullptr);
  EXPECT_TRUE(by_name.at("cvode_bdf").at("adaptive_only"));
  EXPECT_TRUE(by_name.at("cvode_bdf").at("rival"));
  EXPECT_FALSE(by_name.at("dopri5").at("adaptive_only"));
}

TEST(CliList, ProblemsAsJson) {
  Json const list = Json::parse(output_of(Folder(), "list problems --json"));
  std::map<std::string, Json> by_name;
  for (Json const& entry : list) {
    std::string const name = entry.at("name");
    EXPECT_TRUE(by_name.emplace(name, entry).second) << name;
    for (std::string const key : {"variants", "formulations", "parameters", "events", "claims"})
      EXPECT_TRUE(entry.at(key).is_array()) << name << " " << key;
    EXPECT_FALSE(entry.at("formulations").empty()) << name;
    for (Json const& parameter : entry.at("parameters")) {
      EXPECT_TRUE(parameter.at("unit").is_string()) << name << parameter;
      EXPECT_TRUE(parameter.at("default").is_number() || parameter.at("default").is_array()) << name << parameter;
    }
  }
  Json const tether = by_name.at("tether_capture");
  EXPECT_EQ(tether.at("variants").at(0), Json({"case1", "case2", "case3", "free"}));
  Json const first = by_name.at("free_body").at("parameters").at(0);
  EXPECT_EQ(first, Json({{"name", "inertia"}, {"unit", "kg m^2"}, {"default", {100.0, 120.0, 110.0}}}));
}

TEST(CliList, EveryNameIsInEveryForm) {
  for (std::string const what : {"problems", "formulations", "integrators", "policies", "suites"}) {
    std::string const text = output_of(Folder(), "list " + what);
    Json const list = Json::parse(output_of(Folder(), "list " + what + " --json"));
    EXPECT_FALSE(list.empty()) << what;
    for (Json const& entry : list) {
      std::string const name = entry.is_string() ? entry : entry.at("name");
      EXPECT_NE(("\n" + text).find("\n" + name), std::string::npos) << what << " " << name;
    }
  }
}

// ---- simulate -------------------------------------------------------------------------------------------------------

struct Csv {
  Words comments, header;
  std::vector<Words> cells;
  std::vector<std::vector<double>> rows;

  double at(std::size_t row, std::string const& column) const {
    auto const found = std::find(header.begin(), header.end(), column);
    return rows.at(row).at(std::size_t(found - header.begin()));
  }
  std::vector<double> times() const {
    std::vector<double> all;
    for (auto const& row : rows) all.push_back(row.at(0));
    return all;
  }
  bool says(std::string const& comment) const {
    return std::find(comments.begin(), comments.end(), comment) != comments.end();
  }
};

Words fields(std::string const& line) {
  Words all;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) all.push_back(field);
  return all;
}

Csv csv_of(std::string const& text) {
  Csv csv;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) {
      csv.comments.push_back(line);
    } else if (csv.header.empty()) {
      csv.header = fields(line);
    } else {
      csv.cells.push_back(fields(line));
      auto& row = csv.rows.emplace_back();
      for (std::string const& cell : csv.cells.back()) row.push_back(std::stod(cell));
      EXPECT_EQ(row.size(), csv.header.size()) << line;
    }
  }
  return csv;
}

Csv simulate(std::string const& words) {
  Folder const folder;
  Csv const csv = csv_of(output_of(folder, "simulate " + words));
  EXPECT_TRUE(folder.contents().empty());
  return csv;
}

Words const attitude_columns{"t", "q1", "q2", "q3", "q4", "wx", "wy", "wz"};

TEST(CliSimulate, TetherCaptureByGauss) {
  Csv const csv = simulate("tether_capture --integrator gauss4 --h 0.05");
  Words header = attitude_columns;
  for (std::string const own : {"alpha", "tether_force", "torque_x", "torque_y", "torque_z", "energy_c"})
    header.push_back(own);
  EXPECT_EQ(csv.header, header);
  EXPECT_TRUE(csv.says("# problem tether_capture case1,g1"));
  EXPECT_TRUE(csv.says("# gauss4 on quaternion, policy none, h = 0.050000000000000003 s"));
  EXPECT_TRUE(csv.says("# status ok"));
  EXPECT_TRUE(
      csv.says("# units: t [s], wx [rad/s], wy [rad/s], wz [rad/s], alpha [rad], tether_force [N], "
               "torque_x [N m], torque_y [N m], torque_z [N m], energy_c [N^2 m^2 s]"));
  ASSERT_EQ(csv.rows.size(), 501U);  // the sample period is 0.1 s
  std::size_t const end = 500;
  EXPECT_EQ(csv.at(end, "t"), 50);
  EXPECT_NEAR(csv.at(end, "q1"), 0.455362158431, 1e-9);
  EXPECT_NEAR(csv.at(end, "q2"), -9.43413760606e-5, 1e-9);
  EXPECT_NEAR(csv.at(end, "q3"), 4.58088057762e-5, 1e-9);
  EXPECT_NEAR(csv.at(end, "q4"), 0.890306292053, 1e-9);
  EXPECT_NEAR(csv.at(end, "energy_c"), 266.0679905645, 1e-9);
}

TEST(CliSimulate, SeventeenDigits) {
  Csv const csv = simulate("free_body --integrator gauss2 --h 0.1 --t-end 5 --every 0.5");
  EXPECT_EQ(csv.header, attitude_columns);
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    for (std::size_t j = 0; j < csv.rows[i].size(); ++j) {
      std::array<char, 40> text{};
      std::snprintf(text.data(), text.size(), "%.17g", csv.rows[i][j]);
      EXPECT_EQ(csv.cells[i][j], text.data());
    }
  }
}

TEST(CliSimulate, OutputTimes) {
  auto const times = [](std::string const& words) { return simulate(words).times(); };
  std::vector<double> hundredths;
  for (int i = 0; i <= 100; ++i) hundredths.push_back(i * 0.25);
  EXPECT_EQ(times("free_body --integrator rk4 --h 0.125 --t-end 25"), hundredths);
  EXPECT_EQ(times("free_body --integrator rk4 --h 0.125 --t-end 2 --every 0.5"),
            (std::vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(times("free_body --integrator dopri5 --rtol 1e-6 --t-end 2 --every 0.75"),
            (std::vector<double>{0, 0.75, 1.5, 2}));
  EXPECT_EQ(times("free_body --integrator rk4 --h 0.125 --t-end 2 --every 5"), (std::vector<double>{0, 2}));
  EXPECT_EQ(times("tether_capture --integrator rk4 --h 0.0625 --set sample_period=0.25 --t-end 1"),
            (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  // Not every sample is asked for, and samples stay where they are.
  EXPECT_EQ(times("tether_capture --integrator rk4 --h 0.125 --set sample_period=0.25 --t-end 1 --every 0.375"),
            (std::vector<double>{0, 0.375, 0.75, 1}));
}

TEST(CliSimulate, OutTakesTheTrajectory) {
  Folder const folder;
  std::string const words = "simulate free_body --integrator cf4 --formulation so3 --h 0.1 --t-end 1 --every 0.1";
  std::string const text = output_of(folder, words);
  EXPECT_EQ(output_of(folder, words + " --out a.csv"), "");
  EXPECT_EQ(folder.contents(), (std::map<std::string, std::string>{{"a.csv", text}}));
}

TEST(CliSimulate, AFailedRunKeepsItsRows) {
  std::string const words = "free_body --integrator rk4 --h 0.5 --set omega0=1000,2000,3000";
  Result const result = polhode(Folder(), "simulate " + words);
  EXPECT_EQ(result.code, 4);
  EXPECT_EQ(result.err, "polhode: rk4 on free_body: diverged after t = 0.5 s\n");
  Csv const csv = csv_of(result.out);
  EXPECT_EQ(csv.times(), (std::vector<double>{0, 0.5}));
  EXPECT_TRUE(csv.says("# status diverged: diverged after t = 0.5 s"));
  EXPECT_TRUE(csv.says("# omega0 = 1000,2000,3000"));

  Folder const folder;
  Result const to_file = polhode(folder, "simulate " + words + " --out a.csv");
  EXPECT_EQ(to_file.code, 4);
  EXPECT_EQ(to_file.err, result.err);
  EXPECT_EQ(text_of(folder.path / "a.csv"), result.out);
}

TEST(CliSimulate, SetChangesThePhysics) {
  auto const end = [](std::string const& set) {
    // The flag takes one value, so the problem may follow it.
    Csv const csv = simulate(set + " free_body --integrator gauss4 --h 0.125 --t-end 25 --every 25");
    return csv.rows.at(1);
  };
  auto const distance = [](std::vector<double> const& a, std::vector<double> const& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
  };
  auto const principal = end("--set inertia=50,90,110");
  EXPECT_GT(distance(principal, end("")), 0.1);
  EXPECT_LT(distance(principal, end("--set inertia=50,90,110,0,0,0")), 1e-13);
  EXPECT_GT(distance(principal, end("--set inertia=50,90,110,5,0,0")), 0.1);
  EXPECT_LT(distance(principal, end("--set inertia=25,45,55")), 1e-13);  // a free body has no scale of mass

  // 45 degrees about z: diag(50, 90, 110) is (70, 70, 110) with xy = 20 in the turned axes; only its axes differ.
  auto const turned = end("--set inertia=70,70,110,20,0,0 --set q0=0,0,0,1 --set omega0=0.3,0.3,0.5");
  auto const straight = end("--set inertia=50,90,110 --set q0=0,0,0,1 --set omega0=0,0.42426406871192851,0.5");
  EXPECT_NEAR(turned[7], straight[7], 1e-12);
  EXPECT_NEAR(turned[5] * turned[5] + turned[6] * turned[6], straight[5] * straight[5] + straight[6] * straight[6],
              1e-12);
}

// ---- reference ------------------------------------------------------------------------------------------------------

TEST(CliReference, CertifiesAndIsChecked) {
  Folder const folder;
  std::string const line = output_of(folder, "reference free_body --t-end 10 --out data/reference");
  std::string const id = line.substr(0, line.find(' '));
  fs::path const file = fs::path("data/reference") / (id + ".json");
  nlohmann::ordered_json certificate = nlohmann::ordered_json::parse(text_of(folder.path / file));
  EXPECT_EQ(certificate.at("id"), id);
  EXPECT_LT(certificate.at("bar_rad"), 1e-28);
  EXPECT_GE(certificate.at("states").size(), 50U);
  EXPECT_EQ(certificate.at("states").back().at("t"), 10);

  folder.write("mine.toml",
               "name = 'mine'\n[timing]\nenabled = false\n[[sweep]]\nproblem = 'free_body'\nformulation = 's3'\n"
               "integrator = 'gauss4'\nh = 0.1\nt_end = 10\n");
  Words const data{"POLHODE_DATA=" + (folder.path / "data").string()};
  output_of(folder, "run mine.toml --out good", data);

  auto const message_with = [&](std::string const& text) {
    folder.write(file, text);
    Result const result = polhode(folder, "run mine.toml --out bad", data);
    EXPECT_EQ(result.code, 5);
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  std::string const before = "polhode: " + (folder.path / file).string() + ": ";
  std::string const after = "; make it anew with `polhode reference`\n";
  std::string const whole = certificate.dump(1);
  EXPECT_EQ(message_with(whole.substr(0, whole.size() / 2)).rfind(before, 0), 0U);
  certificate["bar_rad"] = 1e-40;
  EXPECT_EQ(message_with(certificate.dump(1)),
            before + "its contents do not match their hash: it was edited or damaged" + after);
  // Even with the right hash, states that today's problem does not pass through are found out.
  certificate.erase("hash");
  certificate["bar_rad"] = 1e-32;
  certificate["states"].back()["hex"][0] = "0x1p-3";
  certificate["hash"] = results::hash_of(certificate.dump());
  std::string const stale = message_with(certificate.dump(1));
  EXPECT_EQ(stale.rfind(before + "stale: at t = 10 s it is ", 0), 0U) << stale;
}

}  // namespace
}  // namespace polhode::cli
