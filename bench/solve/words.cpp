/// The vocabulary, made from the two catalogues.
#include <algorithm>
#include <array>

#include "bench/input/vocabulary.hpp"
#include "bench/solve/problems.hpp"

namespace polhode::bench {
namespace {

constexpr std::array family_names{"explicit_rk", "gauss", "lie_group", "rigid_body",
                                  "splitting",   "exact", "taylor",    "library"};
/// What a method needs in words: in all, and of the space alone.
struct NeedsName {
  Needs needs;
  char const *name, *of_space;
};
constexpr std::array needs_names{NeedsName{Needs::none, "none", "none"},
                                 NeedsName{Needs::flat, "flat", "flat"},
                                 NeedsName{Needs::quaternion, "flat", "flat"},
                                 NeedsName{Needs::group, "group", "group"},
                                 NeedsName{Needs::free_body, "free_body", "free_body"},
                                 NeedsName{Needs::rigid_body, "rigid_body", "none"},
                                 NeedsName{Needs::prescribed_rates, "prescribed_rates", "group"},
                                 NeedsName{Needs::constraint, "constraint", "none"},
                                 NeedsName{Needs::constraint_on_group, "constraint", "none"},
                                 NeedsName{Needs::constraint_on_quaternion, "flat", "flat"}};
struct PreservesName {
  Preserves flag;
  char const* name;
};
constexpr std::array preserves_names{
    PreservesName{keeps_norm, "norm"},          PreservesName{keeps_energy, "energy"},
    PreservesName{keeps_momentum, "momentum"},  PreservesName{keeps_momentum_direction, "momentum_direction"},
    PreservesName{is_symplectic, "symplectic"}, PreservesName{is_symmetric, "symmetric"}};

ProblemWord problem_word(ProblemEntry const& entry) {
  ProblemInfo const& info = entry.info();
  ProblemWord word{.name = info.name,
                   .summary = info.summary,
                   .source = info.source,
                   .variants = info.variants,
                   .formulations = {},
                   .parameters = {},
                   .events = info.events,
                   .claims = {},
                   .step = info.step};
  for (std::string_view name : entry.formulations()) word.formulations.emplace_back(name);
  for (Parameter const& parameter : entry.parameters())
    word.parameters.push_back({parameter.name(), parameter.unit(), parameter.values()});
  for (ClaimInfo const& claim : info.claims) word.claims.push_back(claim.name);
  return word;
}

template <Space M>
IntegratorWord integrator_word(MethodOn<M> const& method) {
  MethodInfo const& info = *method.info;
  IntegratorWord word;
  word.name = info.name;
  word.family = family_names.at(std::size_t(info.family));
  if (info.order > 0) word.order = info.order;
  word.fixed = method.fixed;
  word.adaptive = method.adaptive;
  word.rival = info.rival;
  for (PreservesName const& entry : preserves_names)
    if (info.preserves & entry.flag) word.preserves.emplace_back(entry.name);
  NeedsName const& needs = *std::ranges::find(needs_names, info.needs, &NeedsName::needs);
  word.needs = needs.name;
  word.needs_of_space = needs.of_space;
  word.source = info.source;
  word.pitfall = info.pitfall;
  word.not_built = info.not_built;
  return word;
}

}  // namespace

Vocabulary const& vocabulary() {
  static Vocabulary const words = [] {
    Vocabulary made;
    for (ProblemEntry const* entry : all_problems()) made.problems.push_back(problem_word(*entry));
    for (auto const& method : all_methods_on<RigidBody<FlatQuaternion<double>>>())
      made.integrators.push_back(integrator_word(method));
    for (PolicyName const& entry : policy_names) made.policies.emplace_back(entry.name);
    return made;
  }();
  return words;
}

}  // namespace polhode::bench
