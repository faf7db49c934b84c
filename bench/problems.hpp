#pragma once
/// The problems behind virtual functions: the type of a problem is forgotten here, once per run.
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "bench/methods.hpp"
#include "problems/catalog.hpp"
#include "problems/jet.hpp"

namespace polhode::bench {

/// Series of the references: enough terms for 33 digits at comfortable steps.
using Series = Jet<Quad, 32>;
using SeriesSpace = RigidBody<FlatQuaternion<Series>>;
using QuadSpace = RigidBody<S3<Quad>>;

namespace detail {
template <class List>
struct ProblemIn;
template <class... F>
struct ProblemIn<Types<F...>> {
  using type = std::variant<std::unique_ptr<Erased<RigidBody<typename F::template On<double>>>>...>;
};
}  // namespace detail
/// A problem in one of the formulations, owned.
using ProblemInFormulation = detail::ProblemIn<Formulations>::type;

/// One method bound to one typed problem: what is timed. Everything is made beforehand; solve() starts anew each time.
class TimedSolve {
 public:
  virtual ~TimedSolve() = default;
  virtual Status solve() = 0;
  /// The state where the last solve ended, components in storage order.
  virtual std::vector<double> end_state() const = 0;
};

/// A problem as the user chose it.
class ChosenProblem {
 public:
  virtual ~ChosenProblem() = default;
  virtual ProblemInfo const& info() const = 0;
  virtual double horizon() const = 0;        ///< [s]
  virtual double sample_period() const = 0;  ///< [s]; 0 = continuous
  virtual bool torque_free() const = 0;
  virtual BodyParameters const& body() const = 0;
  virtual std::vector<Column> columns() const = 0;
  virtual std::vector<ClaimResult> claims(History const& history) const = 0;
  /// Throws std::out_of_range for an unknown formulation.
  virtual ProblemInFormulation in(std::string_view formulation) const = 0;
  virtual std::unique_ptr<Erased<SeriesSpace>> as_series() const = 0;
  virtual std::unique_ptr<Erased<QuadSpace>> in_quad() const = 0;
  /// Null if the integrator is refused on the formulation.
  virtual std::unique_ptr<TimedSolve> timed(std::string_view formulation, std::string_view integrator,
                                            Plan const& plan) const = 0;
};

/// A line of the problem catalogue.
class ProblemEntry {
 public:
  virtual ~ProblemEntry() = default;
  virtual ProblemInfo const& info() const = 0;
  /// Name, unit and default of every parameter.
  virtual std::vector<Parameter> parameters() const = 0;
  /// Throws ParameterError if the choice cannot be.
  virtual std::unique_ptr<ChosenProblem> choose(Choice const& choice) const = 0;
};

/// Every problem, in catalogue order.
std::vector<ProblemEntry const*> const& all_problems();
/// The problem of that name. Throws std::out_of_range.
ProblemEntry const& problem_named(std::string_view name);
/// The names of the formulations, in catalogue order.
std::vector<std::string_view> formulation_names();

/// Each problem's own translation units define these two.
template <Definition D>
ProblemEntry const& problem_entry();
template <Definition D, class Methods>
std::unique_ptr<TimedSolve> timed_solve(D const& definition, std::string_view formulation, std::string_view integrator,
                                        Plan const& plan);

}  // namespace polhode::bench
