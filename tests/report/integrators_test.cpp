// The report's section on integrators, from made-up records: what is claimed, what was measured, what is not known.
#include "report/text.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;
using results::IntegratorFacts;

constexpr auto not_measured = "not measured";

results::Catalogue catalogue() {
  return {{"rk4", {"explicit_rk", 4, false, {}, "Kutta (1901)", "the norm drifts"}},
          {"gauss2", {"gauss", 4, false, {"norm", "energy", "momentum", "symmetric"}, "Hairer", "not symplectic"}},
          {"gauss8", {"gauss", 16, false, {"norm", "energy"}, "Hairer", ""}},
          {"cvode_adams", {"library", {}, true, {}, "SUNDIALS", "restarts"}}};
}

Contents contents() {
  Contents c;
  for (double const h : {0.05, 0.1, 0.2, 0.4, 0.8}) {
    c.records.push_back(made("free_body", "", {"rk4", 4, 5e-5, 4, 8.25e-11}, h));
    c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 17, 2.15e-16}, h));
    c.records.push_back(made("pd_slew", "plain", {"gauss2", 4, 7e-6, 16, 2e-16}, h));
    c.records.push_back(made("free_body", "", {"gauss8", 16, 1e-10, 40, 2e-16}, h));
  }
  int n = 1;
  for (Record& r : c.records) {
    if (r.of.problem != "free_body") continue;
    r.energy_drift_max = 1.23e-16 * n;
    r.momentum_drift_max = 2.34e-16 * n;
    r.momentum_direction_max = 3.45e-9 * n;
    ++n;
  }
  c.records.push_back(adaptive(made("free_body", "", {"cvode_adams", 1, 1e-6, 2, 4e-8}, 0.1), 1e-9));
  c.records.back().momentum_direction_max = 5e-8;
  c.catalogue = catalogue();
  return c;
}

/// The columns of one integrator's row of a CSV file without quoted commas, by title; empty if it has none.
std::map<std::string, std::string> csv_row(fs::path const& file, std::string const& integrator) {
  auto const split = [](std::string const& line) {
    std::vector<std::string> entries(1);
    bool quoted = false;
    for (char const c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted)
        entries.emplace_back();
      else if (c != '"')
        entries.back() += c;
    }
    return entries;
  };
  std::istringstream lines(slurp(file));
  std::string line;
  std::getline(lines, line);
  auto const titles = split(line);
  while (std::getline(lines, line)) {
    auto const entries = split(line);
    if (entries.front() != integrator) continue;
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < titles.size(); ++i) row[titles[i]] = entries.at(i);
    return row;
  }
  return {};
}

Record const& record_of(Contents const& c, std::string_view problem, std::string_view integrator, double h) {
  return *std::ranges::find_if(c.records, [&](Record const& r) {
    return r.of.problem == problem && r.of.integrator == integrator && r.of.h == h;
  });
}

TEST(ReportIntegrators, EveryNumberIsTheRecords) {
  Folder const folder;
  Contents const c = contents();
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  auto const file = folder.path / "tables" / "integrators.csv";
  for (auto const* name : {"rk4", "gauss2", "gauss8"}) {
    auto const kept = csv_row(folder.path / "tables" / "integrators-kept.csv", name);
    ASSERT_FALSE(kept.empty()) << name;
    Record const& run = record_of(c, "free_body", name, 0.8);  // nearest to 1 s
    EXPECT_EQ(std::stod(kept.at("norm")), *run.norm_drift_max);
    EXPECT_EQ(std::stod(kept.at("energy")), *run.energy_drift_max);
    EXPECT_EQ(std::stod(kept.at("|L|")), *run.momentum_drift_max);
    EXPECT_EQ(std::stod(kept.at("direction of L [rad]")), *run.momentum_direction_max);
    EXPECT_EQ(kept.at("run"), "quaternion, h = 0.8 s");
    IntegratorFacts const& facts = c.catalogue.at(name);
    EXPECT_EQ(csv_row(file, name).at("family"), facts.family);
    EXPECT_EQ(csv_row(file, name).at("order"), std::to_string(*facts.order));
    auto const source = csv_row(folder.path / "tables" / "integrators-sources.csv", name);
    EXPECT_EQ(source.at("source"), facts.source);
    EXPECT_EQ(source.at("pitfall"), facts.pitfall);
  }
  auto const two = [](std::optional<double> number) { return significant(*number, 2); };
  Record const& gauss = record_of(c, "free_body", "gauss2", 0.8);
  EXPECT_TRUE(contains(text, fmt::format("| gauss2 | {}, claimed | {}, claimed | {}, claimed | {} | symmetric |",
                                         two(gauss.norm_drift_max), two(gauss.energy_drift_max),
                                         two(gauss.momentum_drift_max), two(gauss.momentum_direction_max))));
  EXPECT_TRUE(contains(text, "All that is claimed to be kept is kept within 1e-13"));
  // Orders and evaluations come from the slew where it was run, evaluations at 0.1 s.
  auto const row = csv_row(file, "gauss2");
  EXPECT_NEAR(std::stod(row.at("measured")), 4, 1e-9);
  EXPECT_EQ(row.at("points"), "5");
  EXPECT_EQ(row.at("order measured on"), "pd_slew plain, quaternion");
  Record const& slew = record_of(c, "pd_slew", "gauss2", 0.1);
  EXPECT_EQ(std::stod(row.at("evaluations per step")), double(*slew.evaluations) / double(*slew.steps));
  EXPECT_TRUE(contains(text, "| 16 (pd_slew, h = 0.1 s) |"));
  EXPECT_EQ(csv_row(file, "rk4").at("order measured on"), "free_body, quaternion");
}

TEST(ReportIntegrators, AHighOrderThatLeavesTooFewPointsIsBlank) {
  Folder const folder;
  Contents c = contents();
  for (Record& r : c.records) {  // two points above round-off: 1e-10 * h^16 at 0.8 s, and one told
    if (r.of.integrator != "gauss8") continue;
    r.attitude_error_end = *r.of.h > 0.7 ? 2e-9 : *r.of.h > 0.3 ? 3e-12 : 1e-14;
  }
  markdown_of(c, folder.path);
  auto const row = csv_row(folder.path / "tables" / "integrators.csv", "gauss8");
  EXPECT_EQ(row.at("order"), "16");
  EXPECT_EQ(row.at("measured"), "");
  EXPECT_EQ(row.at("± 95%"), "");
  EXPECT_EQ(row.at("points"), "2");
}

TEST(ReportIntegrators, WithoutTheCatalogueWhatWasMeasuredStays) {
  Folder const folder;
  Contents c = contents();
  c.catalogue.clear();
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "The folder has no `catalogue.json`, which `polhode run` writes beside the records"));
  auto const row = csv_row(folder.path / "tables" / "integrators.csv", "rk4");
  for (auto const* unknown : {"family", "order"}) EXPECT_EQ(row.at(unknown), "") << unknown;
  EXPECT_NEAR(std::stod(row.at("measured")), 4, 1e-9);
  EXPECT_EQ(std::stod(csv_row(folder.path / "tables" / "integrators-kept.csv", "rk4").at("norm")), 8.25e-11);
  EXPECT_FALSE(fs::exists(folder.path / "tables" / "integrators-sources.csv"));
  EXPECT_FALSE(contains(text, ", claimed |"));
  EXPECT_FALSE(contains(text, "All that is claimed"));
}

TEST(ReportIntegrators, WhatTheCatalogueDoesNotKnowIsNamed) {
  Folder const folder;
  Contents c = contents();
  c.catalogue.erase("rk4");
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "The folder's catalogue does not know rk4."));
}

TEST(ReportIntegrators, OnlyFailedCells) {
  Folder const folder;
  Contents c = contents();
  for (Record& r : c.records) {
    if (r.of.integrator != "rk4") continue;
    bool const late = *r.of.h < 0.1;
    r.status = late ? results::Status::timeout : results::Status::diverged;
    r.norm_drift_max = r.energy_drift_max = r.attitude_error_end = r.attitude_error_max = std::nullopt;
  }
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  auto const row = csv_row(folder.path / "tables" / "integrators.csv", "rk4");
  EXPECT_EQ(row.at("family"), "explicit_rk");
  EXPECT_EQ(row.at("order"), "4");
  EXPECT_EQ(row.at("measured"), "");
  EXPECT_EQ(row.at("evaluations per step"), not_measured);
  auto const kept = csv_row(folder.path / "tables" / "integrators-kept.csv", "rk4");
  for (auto const* quantity : {"norm", "energy", "|L|", "direction of L [rad]"})
    EXPECT_EQ(kept.at(quantity), not_measured);
  EXPECT_EQ(kept.at("run"), "");
  EXPECT_EQ(row.at("order measured on"), "4 diverged, 1 timeout");
}

TEST(ReportIntegrators, AdaptiveAloneHasNeitherOrderNorSteps) {
  Folder const folder;
  markdown_of(contents(), folder.path);
  auto const row = csv_row(folder.path / "tables" / "integrators.csv", "cvode_adams");
  EXPECT_EQ(row.at("order"), "");
  EXPECT_EQ(row.at("measured"), "");
  EXPECT_EQ(row.at("evaluations per step"), not_measured);
  EXPECT_EQ(row.at("order measured on"), "no fixed steps");
  auto const kept = csv_row(folder.path / "tables" / "integrators-kept.csv", "cvode_adams");
  EXPECT_EQ(kept.at("norm"), "4e-08");
  EXPECT_EQ(kept.at("energy"), not_measured);
  EXPECT_EQ(kept.at("direction of L [rad]"), "5e-08");
  EXPECT_EQ(kept.at("run"), "quaternion, rtol = 1e-9, atol = 1e-6");
}

TEST(ReportIntegrators, AClaimThatIsNotBorneOutIsSaid) {
  Folder const folder;
  Contents c = contents();
  for (Record& r : c.records) {
    if (r.of.integrator == "gauss2" && r.of.problem == "free_body") r.energy_drift_max = 3.4e-9;
  }
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "Claimed to be kept, and off by more than 1e-13 here: gauss2 energy (3.4e-9)."));
  EXPECT_FALSE(contains(text, "All that is claimed"));
}

TEST(ReportIntegrators, HistoriesOfWhatIsKept) {
  Folder const folder;
  Contents c = contents();
  for (auto const* name : {"rk4", "gauss2"}) {
    Record const& run = record_of(c, "free_body", name, 0.4);
    Series s{run.cell, "invariants", {"t", "energy", "momentum", "momentum_direction"}, {"s", "", "", "rad"}, {}};
    for (int i = 0; i <= 100; ++i) {
      double const t = 0.5 * i;
      bool const drifts = std::string_view(name) == "rk4";
      s.rows.push_back({t, drifts ? -1e-6 * t : 2e-9 * std::sin(t), -3e-5, drifts ? 4e-5 : 0});
    }
    c.series.push_back(s);
  }
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  // 2e-9 |sin t| has both its maxima above 1.99e-9; |L - L0| / |L0| = 3, 4, 5, nearly.
  EXPECT_TRUE(contains(text, "| gauss2 | quaternion | 2e-9 | 2e-9 | 3e-5 | 3e-5 |"));
  EXPECT_TRUE(contains(text, "| rk4 | quaternion | 2.5e-5 | 5e-5 | 5e-5 | 5e-5 |"));
  std::string const points = slurp(folder.path / "figures" / "conservation.csv");
  EXPECT_TRUE(contains(points, "|H/H0 - 1| against t [s],rk4 (quaternion),50,4.9999999999999996e-05"));
  if (have_gnuplot()) {
    EXPECT_TRUE(is_well_formed(slurp(folder.path / "figures" / "conservation.svg")));
  }
  c.series.clear();
  Folder const other{folder.path / "other"};
  EXPECT_FALSE(contains(markdown_of(c, other.path), "Energy and angular momentum against time"));
}

}  // namespace
}  // namespace polhode::report
