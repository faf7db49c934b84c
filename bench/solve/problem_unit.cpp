/// Everything that one problem of the catalogue needs compiled, apart from its races.
/// POLHODE_PROBLEM is the problem's type, from POLHODE_PROBLEM_HEADER; the build makes one unit for each line of
/// problems/catalog.hpp. POLHODE_RACED says that it has races.
#include <algorithm>

#include "bench/solve/problems.hpp"
#include "problems/dual_field.hpp"
#include "problems/series_twin.hpp"
#include POLHODE_PROBLEM_HEADER

namespace polhode::bench {
namespace {

using D = POLHODE_PROBLEM;
// What it lacks is said in words, here, before anything of it is compiled that would stumble over it.
using Field = decltype(std::declval<D const&>().template field<double, FlatQuaternion, true>());
static_assert(Space<typename Field::Space>,
              "Space: Space of what field() makes must be a space, such as RigidBody<A<S>>");
static_assert(Problem<Field>,
              "Problem: a field needs  initial() const  and  operator()(t, x) const -> Velocity<Space>");
static_assert(Definition<D>, "Definition: a member of the problem is missing or of another type; see definition.hpp");

class Chosen final : public ChosenProblem {
 public:
  explicit Chosen(Choice const& choice) : definition_(choice) {}

  ProblemInfo const& info() const override { return D::info(); }
  double horizon() const override { return definition_.horizon; }
  double sample_period() const override { return definition_.sample_period; }
  bool torque_free() const override { return definition_.torque_free(); }
  BodyParameters const* body() const override { return body_of(definition_); }
  std::optional<PinnedBody<Quad>> pinned() const override { return pinned_of<Quad>(definition_); }
  std::optional<Vec3<Quad>> closed_form(Quad t) const override { return closed_form_of(definition_, t); }
  bool switches() const override { return polhode::switches(definition_); }
  bool wants_events() const override { return polhode::wants_events(definition_); }
  std::string no_reference() const override { return why_no_reference(definition_); }
  std::string warning() const override { return warning_of(definition_); }
  std::string refusal(std::string_view formulation) const override {
    std::string const why = refusal_of(definition_, formulation);
    bool const written = std::ranges::count(names_of(FormulationsOf<D>{}), formulation) > 0;
    return why.empty() && !written ? "the problem is not written in this formulation" : why;
  }
  std::vector<Column> columns() const override { return definition_.columns(); }
  std::vector<ClaimResult> claims(History const& history) const override { return definition_.claims(history); }

  ProblemInFormulation in(std::string_view formulation) const override {
    return find(formulation, FormulationsOf<D>{});
  }
  SeriesProblem as_series() const override { return erased<SeriesProblem, Series, FlatQuaternion>(); }
  QuadProblem in_quad() const override { return erased<QuadProblem, Quad, S3>(); }

  std::unique_ptr<TimedSolve> timed(std::string_view formulation, std::string_view integrator,
                                    Plan const& plan) const override {
#ifdef POLHODE_RACED
    if (is_principal(definition_) && is_plain(definition_))
      return raced_solve(definition_, formulation, integrator, plan);
#endif
    return std::visit(
        [&]<Space M>(std::unique_ptr<Erased<M>> field) {
          MethodOn<M> const& method = method_named<M>(integrator);
          return method.timed ? method.timed(std::move(field), plan) : nullptr;
        },
        in(formulation));
  }

 private:
  template <class... F>
  ProblemInFormulation find(std::string_view name, Types<F...>) const {
    ProblemInFormulation found;
    bool const known =
        ((F::name == name ? (found = erased<ProblemInFormulation, double, F::template On>(), true) : false) || ...);
    if (!known) throw std::out_of_range("no formulation " + std::string(name));
    return found;
  }
  /// The field as chosen, with its type forgotten; in double on flat coordinates it knows its Jacobian, unless it is
  /// too large for dense linear algebra. Throws std::out_of_range if no run lives on its space.
  template <class Any, Scalar S, template <class> class A>
  Any erased() const {
    std::optional<Any> any;
    auto const keep = [&]<class P>(P field) {
      if constexpr (std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>>)
        any.emplace(erase_type(WithSeriesTwin<P>(std::move(field), erased_on<SeriesTwin::Space, A>(definition_))));
      else if constexpr (std::constructible_from<Any, std::unique_ptr<Erased<typename P::Space>>>)
        any.emplace(erase_type(std::move(field)));
    };
    with_field<S, A>(definition_, [&]<class P>(P field) {
      if constexpr (std::same_as<S, double> && FlatSpace<typename P::Space>)
        if (size_of(field.initial()) <= most_for_jacobian) return with_differentiable_field<A>(definition_, keep);
      keep(std::move(field));
    });
    if (!any) throw std::out_of_range("no run lives on the space of " + D::info().name);
    return std::move(*any);
  }

  static constexpr int most_for_jacobian = 500;  ///< numbers in a state
  D definition_;
};

class Entry final : public ProblemEntry {
 public:
  ProblemInfo const& info() const override { return D::info(); }
  std::vector<Parameter> parameters() const override { return defaults_.parameters(); }
  std::vector<std::string_view> formulations() const override { return names_of(FormulationsOf<D>{}); }
  std::unique_ptr<ChosenProblem> choose(Choice const& choice) const override {
    return std::make_unique<Chosen>(choice);
  }

 private:
  mutable D defaults_{Choice{}};  // parameters() hands out references; nobody assigns through these
};

}  // namespace

template <>
ProblemEntry const& problem_entry<D>() {
  static Entry const entry;
  return entry;
}

}  // namespace polhode::bench
