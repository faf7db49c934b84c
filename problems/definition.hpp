#pragma once
/// The run-time face of a problem: its name, words, parameters and claims, and the fields that it makes.
///
/// A problem is one header with a type that meets `Definition`, and one line in catalog.hpp. Nothing else is told.
#include <optional>
#include <string>
#include <vector>

#include <cmath>

#include "problems/erased.hpp"
#include "problems/history.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// A published statement that a run can be held against.
struct ClaimInfo {
  std::string name;
  std::string statement;            ///< in our words
  std::optional<double> published;  ///< null if it is not a number
  std::string unit;
};

/// One claim after a run.
struct ClaimResult {
  std::string name;
  std::optional<double> value, published;
  std::optional<bool> holds;  ///< null: nothing is printed to hold it against
};

/// The facts of a problem that do not depend on the user's choice.
struct ProblemInfo {
  std::string name;     ///< the word on the command line
  std::string summary;  ///< one sentence
  std::string source;
  std::vector<std::vector<std::string>> variants;  ///< groups that exclude each other; the first is the default
  std::vector<std::string> events;                 ///< what a method would have to locate or land on
  std::vector<ClaimInfo> claims;
  double step = 0.1;  ///< [s] at which every fixed-step method of the catalogue is stable on the default choice
  std::vector<std::string> driven{};  ///< variant words that change how a run is driven, not what it is held against
  /// The angle to the attitude that the body is steered to: a column of its own [rad], or angle_of_q. Empty: none.
  std::string pointing{};
};
/// As ProblemInfo::pointing: the angle of the attitude itself, for bodies that are steered to q = (0, 0, 0, 1).
inline constexpr char const* angle_of_q = "q";

/// What the catalogue asks of a problem: D(choice) is the problem as chosen; it throws ParameterError when the choice
/// cannot be. A complete one is tests/consumer/damped_body.hpp; problems/README.md goes through it.
///   info()                 the facts above
///   parameters()           name, unit, default, rule
///   horizon, sample_period [s]; 0 = continuous control
///   torque_free()          energy and angular momentum are invariants
///   columns()              what the problem shows beside its state
///   claims(history)        the claims, evaluated
///   field<S, A, fast>()    the problem in scalar S and attitude space A, on one body, Attitudes or RigidBodies
/// and where it applies (see the functions below, which say what holds without)
///   with_field<S, A, fast>(f)  calls f(field) where the choice decides the type of the field, or its space
///   plain()                that choice is field(), which methods are raced on
///   Formulations           those that it can be written in
///   TimedFormulations      those in which methods are raced
///   refusal(formulation)   why this choice makes no sense in one of them
///   principal()            the fast form of the inertia serves
///   body()                 the rigid body, if it is one
///   constrained(), pinned<S>()  a body under a constraint, if the choice has one
///   closed_form(t)         of a state of three numbers
///   switches()             the field has kinks or jumps in the state
///   locate_events          false: let methods run over them
///   no_reference()         why there is no solution to hold a run against
///   warning()              what a user should know of this choice
template <class D>
concept Definition = std::constructible_from<D, Choice const&> && requires(D d, D const c, History const& history) {
  { D::info() } -> std::convertible_to<ProblemInfo const&>;
  { d.parameters() } -> std::same_as<std::vector<Parameter>>;
  { c.horizon } -> std::convertible_to<double>;
  { c.sample_period } -> std::convertible_to<double>;
  { c.torque_free() } -> std::same_as<bool>;
  { c.columns() } -> std::same_as<std::vector<Column>>;
  { c.claims(history) } -> std::same_as<std::vector<ClaimResult>>;
  { c.template field<double, FlatQuaternion, true>() } -> Problem;
};

/// In principal axes unless the definition says otherwise.
template <Definition D>
bool is_principal(D const& definition) {
  if constexpr (requires { definition.principal(); })
    return definition.principal();
  else
    return true;
}
/// Null for problems that are not one rigid body.
template <Definition D>
BodyParameters const* body_of(D const& definition) {
  if constexpr (requires { definition.body(); })
    return &definition.body();
  else
    return nullptr;
}
/// The body under a constraint, if the choice has one.
template <Scalar S, Definition D>
std::optional<PinnedBody<S>> pinned_of(D const& definition) {
  if constexpr (requires { definition.template pinned<S>(); })
    if (definition.constrained()) return definition.template pinned<S>();
  return {};
}
/// The three numbers of a state without attitude at time t [s], if they have a closed form.
template <Definition D>
std::optional<Vec3<Quad>> closed_form_of(D const& definition, Quad t) {
  if constexpr (requires { definition.closed_form(t); })
    return definition.closed_form(t);
  else
    return {};
}
/// The field is smooth unless the definition says otherwise.
template <Definition D>
bool switches(D const& definition) {
  if constexpr (requires { definition.switches(); })
    return definition.switches();
  else
    return false;
}
/// State events are located, by methods that can, unless the definition says otherwise.
template <Definition D>
bool wants_events(D const& definition) {
  if constexpr (requires { definition.locate_events; })
    return definition.locate_events;
  else
    return true;
}
/// Empty: there is a reference.
template <Definition D>
std::string why_no_reference(D const& definition) {
  if constexpr (requires { definition.no_reference(); })
    return definition.no_reference();
  else
    return "";
}
/// Empty: nothing to warn of.
template <Definition D>
std::string warning_of(D const& definition) {
  if constexpr (requires { definition.warning(); })
    return definition.warning();
  else
    return "";
}
/// Empty: the formulation serves.
template <Definition D>
std::string refusal_of(D const& definition, std::string_view formulation) {
  if constexpr (requires { definition.refusal(formulation); })
    return definition.refusal(formulation);
  else
    return "";
}

/// The choice is the field that field() makes, unless the definition says otherwise.
template <Definition D>
bool is_plain(D const& definition) {
  if constexpr (requires { definition.plain(); })
    return definition.plain();
  else
    return true;
}

/// Calls f(field) with the field as chosen.
template <Scalar S, template <class> class A, Definition D, class F>
void with_field(D const& definition, F f) {
  auto const call = [&]<bool fast>() {
    if constexpr (requires { definition.template with_field<S, A, fast>(f); })
      definition.template with_field<S, A, fast>(f);
    else
      f(definition.template field<S, A, fast>());
  };
  if (is_principal(definition))
    call.template operator()<true>();
  else
    call.template operator()<false>();
}

/// The field as chosen with its type forgotten; null if it does not live on the space M.
template <Space M, template <class> class A, Definition D>
std::unique_ptr<Erased<M>> erased_on(D const& definition) {
  std::unique_ptr<Erased<M>> erased;
  with_field<typename M::Scalar, A>(definition, [&](auto field) {
    if constexpr (std::same_as<typename decltype(field)::Space, M>) erased = erase_type(std::move(field));
  });
  return erased;
}
/// The same on the space of field().
template <Scalar S, template <class> class A, Definition D>
auto erase(D const& definition) {
  return erased_on<typename decltype(definition.template field<S, A, true>())::Space, A>(definition);
}

}  // namespace polhode
