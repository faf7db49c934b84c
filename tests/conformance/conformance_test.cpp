/// The catalogues against their own claims: what is kept, who runs, who is refused and why, references certified, timed
/// runs equal to measured ones. Walks the catalogues without naming an entry: a new one is tested by being listed. What
/// a binary adds to them is tested by the same file (polhode_add_conformance).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using bench::IntegratorWord;
using bench::ProblemWord;
using bench::vocabulary;
using test::a_cell;
using test::at_least;
using test::CellUnderTest;
using test::is_walked;

/// Every cell that can be asked for: problem, formulation, integrator, fixed or adaptive, policy. A short horizon.
std::vector<CellUnderTest> every_combination() {
  std::vector<CellUnderTest> cells;
  for (ProblemWord const& problem : vocabulary().problems)
    for (std::string const& variant : test::calm_choices(problem))
      for (std::string const& formulation : problem.formulations)
        for (IntegratorWord const& method : vocabulary().integrators)
          for (std::string const& policy : vocabulary().policies) {
            if (!is_walked(problem.name, method.name)) continue;
            CellUnderTest cell = a_cell(problem.name, formulation, method.name).of_variant(variant);
            cell = cell.until(std::min(3.0, 500 * problem.step));
            cell.cell.policy = policy;
            if (method.fixed) cells.push_back(cell.with_h(problem.step));
            if (method.adaptive) cells.push_back(cell.with_rtol(1e-8));
          }
  return cells;
}
std::string text_of(CellUnderTest const& it) {
  results::Cell const& c = it.cell;
  return c.problem + ", " + c.formulation + ", " + c.integrator + ", " + c.policy + (c.h ? ", fixed" : ", adaptive");
}
/// Calls f(method, formulation) for every method on every space: what the harness knows of it, before any run.
template <class F>
void for_each_method_on_every_space(F f) {
  for (ProblemWord const& problem : vocabulary().problems)
    for (std::string const& variant : test::calm_choices(problem))
      for (std::string const& formulation : problem.formulations) {
        auto const some = a_cell(problem.name, formulation, "gauss2").of_variant(variant).with_h(problem.step);
        auto const choice = bench::prepare(some.cell).problem;
        if (!choice->refusal(formulation).empty()) continue;
        std::visit(
            [&]<Space M>(std::unique_ptr<Erased<M>> const&) {
              for (bench::MethodOn<M> const& method : bench::all_methods_on<M>())
                if (is_walked(problem.name, method.info->name)) f(method, formulation);
            },
            choice->in(formulation));
      }
}

std::vector<IntegratorWord> walked_integrators() {
  std::vector<IntegratorWord> walked;
  for (IntegratorWord const& method : vocabulary().integrators)
    if (is_walked("", method.name)) walked.push_back(method);
  return walked;
}

// ---- Running and refusing -------------------------------------------------------------------------------------------

TEST(Catalogue, EveryMethodRunsOkOrIsRefusedWithAReason) {
  int ran = 0, refused = 0;
  for (CellUnderTest const& cell : every_combination()) {
    auto const prepared = bench::prepare(cell.cell);
    if (!prepared.refusal.empty()) {
      EXPECT_GT(prepared.refusal.size(), 10u) << text_of(cell) << ": a reason is a sentence";
      results::Record const record = cell.measured().record;
      EXPECT_EQ(record.status, results::Status::refused);
      EXPECT_EQ(record.reason, prepared.refusal);
      ++refused;
      continue;
    }
    auto const record = cell.measured().record;
    EXPECT_EQ(record.status, results::Status::ok) << text_of(cell) << ": " << record.reason;
    EXPECT_GT(record.steps.value_or(0), 0) << text_of(cell);
    std::string const needs = vocabulary().integrator(cell.cell.integrator).needs;
    bool const asks = needs != "free_body" && needs != "rigid_body";  // what moves a body exactly need not
    EXPECT_GE(record.evaluations.value_or(0), asks ? record.steps.value_or(0) : 0) << text_of(cell);
    ++ran;
  }
  EXPECT_GT(ran, at_least(100));
  EXPECT_GE(refused, at_least(10));
}

TEST(Catalogue, WhoIsNotRefusedCanBeSolvedAndSteppedSomehow) {
  for_each_method_on_every_space([](auto const& method, std::string_view formulation) {
    EXPECT_EQ(method.solve == nullptr, !method.refusal.empty()) << method.info->name << " on " << formulation;
    EXPECT_TRUE(method.fixed || method.adaptive) << method.info->name;
    EXPECT_EQ(method.info->source.empty(), false) << method.info->name << ": whose method is it?";
    if (method.info->order > 0) {
      EXPECT_TRUE(method.fixed) << method.info->name << ": an order is that of fixed steps";
    }
  });
}

TEST(Catalogue, EveryMethodSuitsSomeFormulation) {
  std::set<std::string_view> all, suited;
  for_each_method_on_every_space([&](auto const& method, std::string_view) {
    if (!is_walked("", method.info->name)) return;
    all.insert(method.info->name);
    if (method.refusal.empty() || !method.info->not_built.empty()) suited.insert(method.info->name);
  });
  EXPECT_EQ(all, suited);
  EXPECT_EQ(all.size(), walked_integrators().size()) << "names must differ";
}

// ---- Timed runs -----------------------------------------------------------------------------------------------------

/// Keeps the last state of a run, in storage order.
template <Space M>
class EndWatch final : public bench::Watch<M> {
 public:
  std::vector<double> state;
  void at_stop(bench::Stop const&, Point<M> const& x) override {
    state.resize(std::size_t(size_of(x)));
    store(x, state.data());
  }
  void after_step(double, Point<M> const&, Projections const&) override {}
};
/// Where the erased, counted run of a prepared cell ends.
std::vector<double> end_of(bench::PreparedCell const& prepared) {
  std::vector<double> end;
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        for (bench::MethodOn<M> const& method : bench::all_methods_on<M>()) {
          if (method.info->name != prepared.cell.integrator) continue;
          EndWatch<M> watch;
          method.solve(*field, prepared.plan, watch);
          end = watch.state;
        }
      },
      prepared.problem->in(prepared.cell.formulation));
  return end;
}

TEST(TimedRuns, EndWhereTheMeasuredOnesEndToTheLastBit) {
  int compared = 0;
  for (CellUnderTest const& cell : every_combination()) {
    auto const prepared = bench::prepare(cell.cell);
    if (!prepared.refusal.empty()) continue;
    auto const timed = prepared.problem->timed(cell.cell.formulation, cell.cell.integrator, prepared.plan);
    if (!timed) {  // on raced problems some methods and formulations are not raced; every rival is where it can run
      EXPECT_FALSE(vocabulary().integrator(cell.cell.integrator).rival && cell.cell.formulation == "quaternion")
          << text_of(cell);
      continue;
    }
    ASSERT_EQ(timed->solve(), Status::ok) << text_of(cell);
    EXPECT_EQ(timed->end_state(), end_of(prepared)) << text_of(cell);
    ++compared;
  }
  EXPECT_GT(compared, at_least(100));
}

// Adaptive steppers keep their step size over a restart; a new solve must begin with a new one all the same.
TEST(TimedRuns, EverySolveIsTheSame) {
  for (CellUnderTest const& cell : every_combination()) {
    auto const prepared = bench::prepare(cell.cell);
    if (!prepared.refusal.empty()) continue;
    auto const timed = prepared.problem->timed(cell.cell.formulation, cell.cell.integrator, prepared.plan);
    if (!timed) continue;
    ASSERT_EQ(timed->solve(), Status::ok) << text_of(cell);
    std::vector<double> const first = timed->end_state();
    ASSERT_EQ(timed->solve(), Status::ok) << text_of(cell);
    EXPECT_EQ(timed->end_state(), first) << text_of(cell);
  }
}

// ---- What is kept ---------------------------------------------------------------------------------------------------

bool claims(IntegratorWord const& method, std::string const& what) {
  return std::find(method.preserves.begin(), method.preserves.end(), what) != method.preserves.end();
}

TEST(Preserves, WhatAMethodClaimsToKeepOfAFreeBodyItKeeps) {
  constexpr double round_off = 1e-13;  // 500 steps, each wrong by a few units in the last place
  std::map<std::string, int> checked;
  for (IntegratorWord const& method : walked_integrators())
    for (std::string_view formulation : bench::formulation_names()) {
      if (!method.fixed || method.preserves.empty()) continue;
      auto const cell = a_cell("free_body", formulation, method.name).with_h(0.1);
      if (!bench::prepare(cell.cell).refusal.empty()) continue;
      auto const record = cell.measured().record;
      auto const expect_kept = [&](char const* what, std::optional<double> drift) {
        if (!claims(method, what)) return;
        EXPECT_LT(drift.value_or(1), round_off) << what << " by " << method.name << " as " << formulation;
        ++checked[what];
      };
      expect_kept("norm", record.norm_drift_max);
      expect_kept("energy", record.energy_drift_max);
      expect_kept("momentum", record.momentum_drift_max);
      expect_kept("momentum_direction", record.momentum_direction_max);
    }
  for (char const* what : {"norm", "energy", "momentum"}) EXPECT_GE(checked[what], at_least(10)) << what;
}

TEST(Preserves, NotEveryMethodKeepsEverything) {
  if (!is_walked("", "")) GTEST_SKIP() << "of the whole catalogue";
  std::map<std::string, int> losers;  // or the drifts above could not be told from a measure that is always 0
  for (IntegratorWord const& method : vocabulary().integrators) {
    auto const cell = a_cell("free_body", bench::formulation_names().front(), method.name).with_h(0.5);
    if (!method.fixed || !bench::prepare(cell.cell).refusal.empty()) continue;
    auto const record = cell.measured().record;
    losers["norm"] += *record.norm_drift_max > 1e-9 ? 1 : 0;
    losers["energy"] += *record.energy_drift_max > 1e-9 ? 1 : 0;
    losers["momentum"] += *record.momentum_drift_max > 1e-9 ? 1 : 0;
    losers["direction"] += *record.momentum_direction_max > 1e-9 ? 1 : 0;
  }
  for (char const* what : {"norm", "energy", "momentum", "direction"}) EXPECT_GE(losers[what], 2) << what;
}

TEST(Preserves, MethodsOnGroupsKeepTheNormOverTenThousandSteps) {
  int checked = 0;
  for (std::string_view formulation : bench::formulation_names()) {
    auto const choice = bench::problem_named("free_body").choose({});
    std::visit(
        [&]<Space M>(std::unique_ptr<Erased<M>> const&) {
          for (bench::MethodOn<M> const& method : bench::all_methods_on<M>()) {
            if constexpr (!M::flat) {
              if (!method.refusal.empty() || !method.fixed || !(method.info->preserves & keeps_norm)) continue;
              if (!is_walked("", method.info->name)) continue;
              auto const field = std::get<std::unique_ptr<Erased<M>>>(choice->in(formulation));
              bench::Plan const plan = test::ten_thousand_steps();
              test::DefectWatch<M> watch;
              EXPECT_EQ(method.solve(*field, plan, watch).status, Status::ok) << method.info->name;
              EXPECT_EQ(watch.steps, 10'000);
              EXPECT_LT(watch.worst, test::round_off_of_norm) << method.info->name << " as " << formulation;
              ++checked;
            }
          }
        },
        choice->in(formulation));
  }
  EXPECT_GE(checked, at_least(10));
  auto const claimants = [](IntegratorWord const& method) {
    return method.fixed && method.needs == "group" && claims(method, "norm");
  };
  EXPECT_GE(checked, std::ranges::count_if(walked_integrators(), claimants));
}

// ---- References -----------------------------------------------------------------------------------------------------

/// A problem as it is by default, or with one word of its variants.
struct CertifiedChoice {
  std::string problem, variant;

  friend void PrintTo(CertifiedChoice const& c, std::ostream* out) { *out << c.problem << ' ' << c.variant; }
};
/// Without the words that only drive a run: it is then held against the same reference.
std::vector<CertifiedChoice> certified_choices() {
  std::vector<CertifiedChoice> choices;
  for (ProblemWord const& problem : vocabulary().problems) {
    if (!is_walked(problem.name, "")) continue;
    choices.push_back({problem.name, ""});
    auto const& driven = bench::problem_named(problem.name).info().driven;
    for (auto const& group : problem.variants)
      for (std::size_t i = 1; i < group.size(); ++i)
        if (std::ranges::find(driven, group[i]) == driven.end()) choices.push_back({problem.name, group[i]});
  }
  return choices;
}

/// A test each, so that two cores share them: those of so3_cooperative take three quarters of the time.
class References : public testing::TestWithParam<CertifiedChoice> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(References);
INSTANTIATE_TEST_SUITE_P(Of, References, testing::ValuesIn(certified_choices()), [](auto const& each) {
  return each.param.problem + (each.param.variant.empty() ? "" : "_" + each.param.variant);
});

TEST_P(References, AreCertifiedToTwentyEightDigits) {
  auto const& [name, variant] = GetParam();
  auto const problem = std::ranges::find(vocabulary().problems, name, &ProblemWord::name);
  auto const cell = a_cell(name, problem->formulations.front(), "gauss2").of_variant(variant).with_h(problem->step);
  // Its whole horizon if it is that of one body and the default; short ones tell of the others, networks' are dear.
  bool const whole = variant.empty() && bench::problem_named(name).choose({})->body();
  auto const record = (whole ? cell : cell.until(std::min(5.0, std::max(1.0, 40 * problem->step)))).measured().record;
  if (!bench::prepare(cell.cell).problem->no_reference().empty()) {
    EXPECT_FALSE(record.reference_bar);
    return;
  }
  ASSERT_TRUE(record.reference_bar);
  EXPECT_LT(*record.reference_bar, 1e-28);
  if (variant == "trap") return;  // an equilibrium: nothing moves
  EXPECT_GT(*record.reference_bar, 0) << "two methods agree to the last bit?";
}

}  // namespace
}  // namespace polhode
