// The interactive part of the report: its data are the records', no text of a record leaves its place, polhodes lie
// where both integrals of motion put them, and many records stay few seconds and a page that can be opened.
#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "problems/free_body.hpp"
#include "report/located.hpp"
#include "report/render/page.hpp"
#include "report/text.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;
using Json = nlohmann::json;

constexpr char const* hostile = "</script><script>alert(1)</script><!--&\"'\\ \x01\xff";

Facts const& facts_of_full() {
  static Contents const contents = full();
  static Facts const facts(contents);
  return facts;
}

/// A visitor that holds each field of a record against its column.
struct SameAs {
  Json const& records;
  std::size_t place;

  void number(char const* name, std::optional<double> const& wanted) const {
    Json const& numbers = records["numbers"];
    if (!numbers.contains(name)) {
      EXPECT_FALSE(finite(wanted)) << name;
      return;
    }
    Json const& found = numbers[name]["values"][place];
    if (!finite(wanted)) {
      EXPECT_TRUE(found.is_null()) << name;
    } else {
      EXPECT_EQ(found.get<double>(), *wanted) << name;
    }
  }
  void text(char const* name, std::string const& wanted) const {
    Json const& column = records["texts"][name];
    EXPECT_EQ(column["words"][column["at"][place].get<std::size_t>()], wanted) << name;
  }
  void operator()(char const* name, char const*, std::optional<double> const& v) const { number(name, v); }
  void operator()(char const* name, char const*, double const& v) const { number(name, v); }
  void operator()(char const* name, char const*, std::int64_t const& v) const { number(name, static_cast<double>(v)); }
  void operator()(char const* name, char const*, std::optional<std::int64_t> const& v) const {
    number(name, v ? std::optional(static_cast<double>(*v)) : std::nullopt);
  }
  void operator()(char const* name, char const*, std::optional<results::CpuTime> const& v) const {
    number(name, v ? std::optional(v->median) : std::nullopt);
    number("cpu_time_s_low", v ? std::optional(v->low) : std::nullopt);
    number("cpu_time_s_high", v ? std::optional(v->high) : std::nullopt);
  }
  void operator()(char const* name, char const*, std::string const& v) const { text(name, v); }
  void operator()(char const* name, char const*, results::Status const& v) const {
    text(name, std::string(results::name_of(v)));
  }
  template <class T>
  void operator()(char const*, char const*, std::map<std::string, T> const&) const {}
};

TEST(PageData, HoldsEveryRecordAsItIs) {
  Facts const& facts = facts_of_full();
  Json const records = Json::parse(script_safe(page_data(facts)))["records"];
  ASSERT_EQ(records["count"], facts.runs.size());
  for (std::size_t i = 0; i < facts.runs.size(); ++i) results::for_each_field(*facts.runs[i], SameAs{records, i});
  EXPECT_EQ(records["numbers"]["attitude_error_max"]["unit"], "rad");
  EXPECT_FALSE(records["numbers"].contains("multiplier_error_max")) << "nobody has it";
}

TEST(PageData, CostsAndOrdersAreThoseOfTheTables) {
  Facts const& facts = facts_of_full();
  Json const data = page_data(facts);
  ASSERT_EQ(data["instances"].size(), facts.instances.size());
  std::size_t reached = 0;
  for (std::size_t i = 0; i < facts.instances.size(); ++i) {
    Instance const& instance = facts.instances[i];
    Json const& json = data["instances"][i];
    EXPECT_EQ(json["label"], instance.label);
    auto const sweeps = instance.sweeps();
    ASSERT_EQ(json["sweeps"].size(), sweeps.size());
    for (std::size_t target = 0; target < data["targets"].size(); ++target) {
      for (auto const& [name, measure] : {std::pair{"time", Measure::time}, {"evaluations", Measure::evaluations}}) {
        std::map<std::string, double> best;
        for (Json const& sweep : json["sweeps"]) {
          if (sweep[name][target].is_null()) continue;
          Record const& run = *facts.runs[sweep[name][target][3].get<std::size_t>()];
          double const cost = sweep[name][target][0].get<double>();
          auto const at = best.try_emplace(run.of.integrator, cost).first;
          at->second = std::min(at->second, cost);
        }
        std::map<std::string, double> wanted;
        for (Cost const& c : ranking(instance, data["targets"][target].get<double>(), measure)) {
          wanted[c.run->of.integrator] = c.value;
        }
        EXPECT_EQ(best, wanted) << instance.label;
        reached += wanted.size();
      }
    }
    for (std::size_t k = 0; k < sweeps.size(); ++k) {
      auto const fit = order_of(sweeps[k]).fit;
      if (!fit) continue;
      EXPECT_EQ(json["sweeps"][k]["order"]["slope"], fit->slope);
    }
  }
  EXPECT_GT(reached, 20U);
}

TEST(PageData, HistoriesKeepTheirPeaks) {
  Contents c;
  c.records.push_back(made("free_body", "", {"rk4", 4, 5e-3, 4, 8e-11}, 0.1));
  Series s{c.records[0].cell, "drift", {"t", "norm_drift"}, {"s", ""}, {}};
  for (int i = 0; i <= 20'000; ++i) s.rows.push_back({0.01 * i, i == 777 ? -3.25e-5 : 1e-9});
  c.series.push_back(s);
  Json const data = page_data(Facts(c));
  ASSERT_EQ(data["series"].size(), 1U);
  auto const values = data["series"][0]["columns"][1]["values"].get<std::vector<double>>();
  EXPECT_LE(values.size(), 60U);
  EXPECT_EQ(*std::ranges::max_element(values), 3.25e-5);
  EXPECT_EQ(data["series_left_out"], 0);
}

TEST(PageData, NoTextEndsItsScript) {
  Contents c = full();
  for (Record& r : c.records) {
    r.reason = r.build = r.of.integrator = r.of.problem = hostile;
    r.of.set[hostile] = {1};
  }
  for (Series& s : c.series) s.columns.back() = s.units.back() = hostile;
  c.catalogue[hostile].family = hostile;
  Facts const facts(c);
  std::string const text = script_safe(page_data(facts));
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(text)["records"]["texts"]["reason"]["words"][0], one_line(hostile));
  Folder const folder;
  markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_FALSE(contains(slurp(folder.path / "report.html"), "alert(1)</script"));
}

TEST(Page, SaysWhyItHasNoInteractivePart) {
  Facts const& facts = facts_of_full();
  Interactive const without = interactive_part(facts, {"", "code", ""});
  EXPECT_TRUE(contains(without.section, "This page has no interactive part: polhode was built without plotly."));
  EXPECT_TRUE(without.scripts.empty());
  EXPECT_TRUE(interactive_part(Facts(Contents{}), {"", "code", "plotly"}).section.empty()) << "no runs, nothing to say";
}

TEST(Page, HoldsCodeLibraryAndDataOnce) {
  PageAssets const assets = page_assets();
  EXPECT_TRUE(contains(std::string(assets.code), "class Records"));
  EXPECT_FALSE(contains(std::string(assets.code), "\nimport ")) << "one module";
  EXPECT_FALSE(contains(std::string(assets.code), "\nexport "));
  Interactive const part = interactive_part(facts_of_full(), {assets.style, assets.code, "/*the library*/"});
  for (auto const* once : {"/*the library*/", "class Records", "id=\"polhode-data\""}) {
    auto const first = part.scripts.find(once);
    ASSERT_NE(first, std::string::npos) << once;
    EXPECT_EQ(part.scripts.find(once, first + 1), std::string::npos) << once;
  }
  if (assets.plotly.empty()) GTEST_SKIP() << "built without plotly";
  EXPECT_TRUE(contains(std::string(assets.plotly), "Licensed under the MIT license"));
}

TEST(Page, SmallEnoughToSend) {
  Folder const folder;
  markdown_of(full(), folder.path);
  EXPECT_LT(fs::file_size(folder.path / "report.html"), 6'000'000U);
}

/// Of this process and of the gnuplots that it waited for: others on the machine do not count.
double processor_seconds() {
  double sum = 0;
  for (int const who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    ::getrusage(who, &used);
    for (timeval const& t : {used.ru_utime, used.ru_stime}) {
      sum += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
  }
  return sum;
}

TEST(Page, TwentyThousandRecords) {
  Contents c;
  std::vector<std::string> const methods{"rk4", "dopri5", "gauss2", "gauss4", "cf4", "odeint_rk4", "cvode_adams", "x"};
  for (int i = 0; i < 20'000; ++i) {
    double const h = 0.4 / (1 << (i % 10));
    Record r = made("free_body", "", {methods[static_cast<std::size_t>(i / 10 % 8)], 4, 5e-3, 4, 1e-11}, h);
    r.of.set["omega0"] = {0.1, 0.2, 0.001 * (i / 80)};
    r.cell += fmt::format("/{}", i / 80);
    if (i % 97 == 0) r.status = results::Status::diverged;
    c.records.push_back(r);
    if (i % 5 == 0) c.series.push_back(drift_of(r));
  }
  Folder const folder;
  double const before = processor_seconds();
  markdown_of(c, folder.path);
  EXPECT_LT(processor_seconds() - before, 20);
  EXPECT_LT(fs::file_size(folder.path / "report.html"), 24'000'000U);  // 1 kB a record, and the static pictures
  Json const data = page_data(Facts(c));
  EXPECT_EQ(data["records"]["count"], 20'000);
  EXPECT_GT(data["series_left_out"].get<int>(), 0);
  EXPECT_LE(data["spins"].size(), 8U);
}

TEST(Polhode, LiesOnBothQuadrics) {
  for (FreeSpin const& spin : {FreeSpin{{100, 120, 110}, {0.17, 0.17, 0.17}}, FreeSpin{{3, 1, 2}, {-0.4, 2, 0.3}},
                               FreeSpin{{1, 1, 2}, {0.3, 0.1, -1}}, FreeSpin{{1, 2, 2}, {0.3, 0.1, -1}}}) {
    double const e = spin.energy_twice(), l2 = spin.momentum_squared();
    auto const own = own_polhode(spin);
    ASSERT_FALSE(own.empty());
    double nearest = INFINITY;
    for (Triple const& w : own) {
      FreeSpin const there{spin.inertia, w};
      EXPECT_NEAR(there.energy_twice() / e, 1, 1e-12);
      EXPECT_NEAR(there.momentum_squared() / l2, 1, 1e-12);
      nearest = std::min(nearest, std::hypot(w[0] - spin.omega0[0], w[1] - spin.omega0[1], w[2] - spin.omega0[2]));
    }
    EXPECT_LT(nearest, 0.06 * std::sqrt(e / spin.inertia[0])) << "the motion's own, not its mirror image";
    for (RateCurve const& curve : polhode_family(spin)) {
      for (Triple const& w : curve) EXPECT_NEAR((FreeSpin{spin.inertia, w}.energy_twice() / e), 1, 1e-12);
    }
  }
}

TEST(Polhode, NoneWhereEveryRateStays) {
  EXPECT_TRUE(own_polhode({{2, 2, 2}, {1, 2, 3}}).empty());
  EXPECT_TRUE(own_polhode({{1, 2, 3}, {0, 0, 0}}).empty());
  EXPECT_TRUE(polhodes({1, 2, 3}, 1, 3.5).empty()) << "the quadrics do not meet";
  EXPECT_TRUE(is_well_formed(polhode_svg({{100, 120, 110}, {0.1, 0.2, 0.3}}, hostile)));
  EXPECT_TRUE(polhode_svg({{1, 2, 3}, {0, 0, 0}}, "at rest").empty());
}

Triple problem_rate(FreeBody const& problem) {
  return {problem.body().omega0[0], problem.body().omega0[1], problem.body().omega0[2]};
}

TEST(Polhode, BodiesAreThoseOfTheRecords) {
  Contents c;
  c.records.push_back(made("free_body", "", {"rk4", 4, 5e-3, 4, 8e-11}, 0.1));
  c.records.push_back(made("free_body", "", {"rk4", 4, 5e-3, 4, 8e-11}, 0.2));
  for (auto const& inertia : {std::vector<double>{1, 2, 3}, std::vector<double>{1, 2, 3, 0.1, 0, 0}}) {
    c.records.push_back(made("free_body", "", {"rk4", 4, 5e-3, 4, 8e-11}, 0.1));
    c.records.back().of.set["inertia"] = inertia;
    c.records.back().cell += std::to_string(inertia.size());
  }
  c.records.push_back(made("pd_slew", "plain", {"rk4", 4, 5e-3, 4, 8e-11}, 0.1));
  Facts const facts(c);
  auto const spins = free_spins(facts);
  ASSERT_EQ(spins.size(), 3U) << "the slew has a torque";
  FreeBody const problem{Choice{}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(spins[0].spin.inertia[i], problem.body().inertia[i]) << "the problem's own";
    EXPECT_DOUBLE_EQ(spins[0].spin.omega0[i], problem.body().omega0[i]);
    EXPECT_EQ(spins[2].spin.inertia[i], static_cast<double>(i + 1));
  }
  EXPECT_FALSE(spins[2].has_products);
  EXPECT_TRUE(spins[1].has_products);
  // In body axes and in principal ones the same energy and momentum.
  Triple const w = problem_rate(problem);
  Triple const momentum{w[0] + 0.1 * w[1], 0.1 * w[0] + 2 * w[1], 3 * w[2]};
  EXPECT_NEAR(spins[1].spin.energy_twice(), momentum[0] * w[0] + momentum[1] * w[1] + momentum[2] * w[2], 1e-15);
  EXPECT_NEAR(spins[1].spin.momentum_squared(),
              momentum[0] * momentum[0] + momentum[1] * momentum[1] + momentum[2] * momentum[2], 1e-15);
  Json const data = page_data(facts);
  EXPECT_TRUE(data["spins"][2]["axes"].is_null());
  EXPECT_EQ(data["spins"][1]["axes"].size(), 3U);
}

TEST(Polhode, PrincipalAxesDiagonalise) {
  constexpr std::array<double, 6> general{100, 120, 110, 7, -11, 4}, nearly_equal{2, 2, 2, 1e-9, 0, 1e-9};
  for (auto const& j : {general, nearly_equal, std::array<double, 6>{3, 1, 2, 0, 0, 0}}) {
    double const matrix[3][3] = {{j[0], j[3], j[4]}, {j[3], j[1], j[5]}, {j[4], j[5], j[2]}};
    PrincipalAxes const body = principal_axes(j);
    auto const& a = body.axes;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        double length = 0, moment = 0;
        for (std::size_t m = 0; m < 3; ++m) {
          length += a[i][m] * a[k][m];
          for (std::size_t n = 0; n < 3; ++n) moment += a[i][m] * matrix[m][n] * a[k][n];
        }
        EXPECT_NEAR(length, i == k ? 1 : 0, 1e-14);
        EXPECT_NEAR(moment, i == k ? body.moments[i] : 0, 1e-13 * j[1]);
      }
    }
    double const volume = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
                          a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
                          a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    EXPECT_NEAR(volume, 1, 1e-14) << "right-handed";
  }
  PrincipalAxes const own = principal_axes({3, 1, 2, 0, 0, 0});
  EXPECT_EQ(own.moments, (Triple{3, 1, 2})) << "what is diagonal stays as it is";
}

}  // namespace
}  // namespace polhode::report
