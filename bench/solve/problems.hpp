#pragma once
/// The problems behind virtual functions: the type of a problem is forgotten here, once per run.
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "bench/solve/methods.hpp"
#include "problems/definition.hpp"
#include "problems/jet.hpp"

namespace polhode::bench {

/// Series of the references: enough terms for 33 digits at comfortable steps.
using Series = Jet<Quad, 32>;

namespace detail {
template <class List>
struct ErasedOn;
template <class... M>
struct ErasedOn<Types<M...>> {
  using type = std::variant<std::unique_ptr<Erased<M>>...>;
};
/// One body, many attitudes, many bodies, three numbers, a body that moves in space.
template <class A>
using Kinds = Types<RigidBody<A>, Attitudes<A>, RigidBodies<A>, Euclidean3<typename A::Scalar>, MovingBody<A>>;
}  // namespace detail
/// A problem on one of the spaces that runs live on, owned.
using ProblemInFormulation =
    detail::ErasedOn<Joined<OneBodySpaces, AttitudesSpaces, BodiesSpaces, PositionSpaces>>::type;
/// The same for the two methods of a reference.
using SeriesProblem = detail::ErasedOn<detail::Kinds<FlatQuaternion<Series>>>::type;
using QuadProblem = detail::ErasedOn<detail::Kinds<S3<Quad>>>::type;

/// A problem as the user chose it.
class ChosenProblem {
 public:
  virtual ~ChosenProblem() = default;
  virtual ProblemInfo const& info() const = 0;
  virtual double horizon() const = 0;        ///< [s]
  virtual double sample_period() const = 0;  ///< [s]; 0 = continuous
  virtual bool torque_free() const = 0;
  /// The rigid body; null if the problem is not one.
  virtual BodyParameters const* body() const = 0;
  /// The state at time t where there is a closed form of three numbers.
  virtual std::optional<Vec3<Quad>> closed_form(Quad t) const = 0;
  /// The body under a constraint; null if the problem has none.
  virtual std::optional<PinnedBody<Quad>> pinned() const = 0;
  virtual bool switches() const = 0;      ///< the field has kinks or jumps in the state
  virtual bool wants_events() const = 0;  ///< methods that can are to locate them
  /// Why there is no reference, what to warn of, why a formulation makes no sense; empty if none of it applies.
  virtual std::string no_reference() const = 0;
  virtual std::string warning() const = 0;
  virtual std::string refusal(std::string_view formulation) const = 0;
  virtual std::vector<Column> columns() const = 0;
  virtual std::vector<ClaimResult> claims(History const& history) const = 0;
  /// Throws std::out_of_range for a formulation that is unknown or makes no sense.
  virtual ProblemInFormulation in(std::string_view formulation) const = 0;
  virtual SeriesProblem as_series() const = 0;
  virtual QuadProblem in_quad() const = 0;
  /// On raced problems typed code; null for methods and formulations that are not raced. On others, and where an
  /// inertia has products, everything goes through virtual calls. Null, too, if the integrator is refused on the
  /// formulation.
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
  /// The formulations that it can be written in.
  virtual std::vector<std::string_view> formulations() const = 0;
  /// Throws ParameterError if the choice cannot be.
  virtual std::unique_ptr<ChosenProblem> choose(Choice const& choice) const = 0;
};

/// Every problem, in catalogue order, and behind them what this binary adds: from its catalogue_unit.cpp.
std::vector<ProblemEntry const*> const& all_problems();
/// The problem of that name. Throws std::out_of_range.
ProblemEntry const& problem_named(std::string_view name);
/// The names of the formulations of a list, in its order.
template <class... F>
std::vector<std::string_view> names_of(Types<F...>) {
  return {F::name...};
}
/// The names of all formulations, in catalogue order.
std::vector<std::string_view> formulation_names();

namespace detail {
template <class D>
auto formulations_of() {
  if constexpr (requires { typename D::Formulations; })
    return typename D::Formulations{};
  else
    return Formulations{};
}
template <class D>
auto timed_formulations_of() {
  if constexpr (requires { typename D::TimedFormulations; })
    return typename D::TimedFormulations{};
  else
    return TimedFormulations{};
}
}  // namespace detail
/// The formulations that D can be written in: all of one body, unless D says otherwise.
template <Definition D>
using FormulationsOf = decltype(detail::formulations_of<D>());
/// Those in which it is timed.
template <Definition D>
using TimedFormulationsOf = decltype(detail::timed_formulations_of<D>());

/// Each problem's own translation units define these two; the second those of raced problems.
/// Methods is one of RaceLists, or a list that a binary adds.
template <Definition D>
ProblemEntry const& problem_entry();
template <Definition D, class Methods>
std::unique_ptr<TimedSolve> timed_solve(D const& definition, std::string_view formulation, std::string_view integrator,
                                        Plan const& plan);
/// The same by whichever of these lists has the integrator: from the binary's catalogue_unit.cpp.
template <Definition D>
std::unique_ptr<TimedSolve> raced_solve(D const& definition, std::string_view formulation, std::string_view integrator,
                                        Plan const& plan);

}  // namespace polhode::bench
