/// The libraries against the certified references, wherever they run: a wrong right-hand side, a restart that is missed
/// at a sample or a phase, or a torque that is not held between samples, would be far beyond the bounds.
#include <gtest/gtest.h>

#include <algorithm>

#include "integrators/catalog/rivals.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/rival_runs.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using bench::IntegratorWord;
using bench::ProblemWord;
using bench::vocabulary;
using test::a_cell;
using test::CellUnderTest;

/// As tight as double precision has sense, for a short time.
CellUnderTest tight(ProblemWord const& problem, std::string const& variant, std::string const& formulation,
                    IntegratorWord const& method) {
  CellUnderTest const cell =
      a_cell(problem.name, formulation, method.name).of_variant(variant).until(std::min(3.0, 500 * problem.step));
  return method.adaptive ? cell.with_rtol(1e-11) : cell.with_h(problem.step / 8);
}

TEST(Rivals, AgreeWithTheReferencesWhereverTheyRun) {
  std::map<std::string, std::set<std::string>> problems_of;
  for (ProblemWord const& problem : vocabulary().problems)
    for (std::string const& variant : test::calm_choices(problem))
      for (std::string const& formulation : problem.formulations)
        for (IntegratorWord const& method : vocabulary().integrators) {
          if (!method.rival || !method.not_built.empty()) continue;
          auto const cell = tight(problem, variant, formulation, method);
          if (!bench::prepare(cell.cell).refusal.empty()) continue;
          auto const record = cell.measured().record;
          std::string const text = method.name + " on " + problem.name + " " + variant + " as " + formulation;
          ASSERT_EQ(record.status, results::Status::ok) << text << ": " << record.reason;
          ASSERT_TRUE(record.attitude_error_max || record.rate_error_max) << text << ": nothing is compared";
          EXPECT_LT(record.attitude_error_max.value_or(0), 2e-8) << text;
          EXPECT_LT(record.rate_error_max.value_or(0), 2e-8) << text;
          problems_of[method.name].insert(problem.name);
        }
  for (IntegratorWord const& method : vocabulary().integrators)
    if (method.rival && method.not_built.empty()) {
      EXPECT_GE(problems_of[method.name].size(), 5u) << method.name;
    }
}

// ---- That the bounds can tell
// ----------------------------------------------------------------------------------------

/// A stepper that is deaf to restarts: it goes on from its own history.
template <class Method>
struct Deaf {
  template <class Stepper>
  struct Muffled : Stepper {
    using Stepper::Stepper;
    explicit Muffled(Stepper stepper) : Stepper(std::move(stepper)) {}
    void restart() {}
  };
  template <class P, class Control>
  auto bind(P const& p, Control control, NormPolicy policy) const {
    auto stepper = Method{}.bind(p, control, policy);
    return Muffled<decltype(stepper)>(std::move(stepper));
  }
};
template <class Method, class Control>
double error_on_the_tether(Control control) {
  TetherCapture const definition(Choice{});
  auto const reference = test::reference_state(definition, 0.05, 2);
  auto const run = test::run_rival<Method>(definition, 2, control);
  return test::error_of(run.x, reference);
}

TEST(Rivals, AMissedRestartIsSeen) {
  EXPECT_LT(error_on_the_tether<OdeintAbm8>(FixedStep{0.0125}), 2e-8);
  EXPECT_GT(error_on_the_tether<Deaf<OdeintAbm8>>(FixedStep{0.0125}), 1e-7);
#ifdef POLHODE_HAS_SUNDIALS
  EXPECT_LT(error_on_the_tether<Cvode<true>>(Adaptive{1e-11, 1e-13}), 2e-8);
  EXPECT_GT(error_on_the_tether<Deaf<Cvode<true>>>(Adaptive{1e-11, 1e-13}), 1e-7);
#endif
}

}  // namespace
}  // namespace polhode
