#include "bench/cell/refusal.hpp"

namespace polhode::bench {
namespace {

template <Space M>
constexpr bool quaternion_body = false;
template <Attitude A>
constexpr bool quaternion_body<RigidBody<A>> = std::same_as<Point<A>, Quat<double>>;

/// The same of the policies that need steps of our own: where the feedback acts, or what a step is.
template <Space M>
std::string_view own_policy_refusal(MethodInfo const& info, NormPolicy policy, bool adaptive) {
  if (info.rival) return "a library takes its steps itself: this policy is built into our own";
  if (!M::flat) return "on a group there is no defect to feed back or to relax (formulation quaternion)";
  if (policy == NormPolicy::baumgarte) return info.no_feedback;
  if (!OneFlatQuaternion<M>) return "this policy is for one body on flat quaternions (formulation quaternion)";
  if (policy == NormPolicy::project_symmetric && adaptive) return "symmetric projection is that of equal steps (--h)";
  return info.no_relaxation;
}

/// Why a norm policy is refused for a method on space M; empty if it is not.
template <Space M>
std::string_view policy_refusal(MethodInfo const& info, NormPolicy policy, bool adaptive) {
  if (policy == NormPolicy::none) return "";
  if (!M::constrained) return "this formulation has no norm to project";
  if (policy == NormPolicy::native) return info.projects_natively ? "" : "has no projection of its own";
  if (policy == NormPolicy::project_multiplier && !quaternion_body<M>)
    return "the multiplier form of the projection is that of one body's quaternion";
  if (is_projection(policy)) return info.no_projection;
  return own_policy_refusal<M>(info, policy, adaptive);
}

/// What a method needs of the problem beside its space; empty if it is there.
template <Space M>
std::string_view problem_refusal(Needs needs, Erased<M> const& field) {
  if constexpr (requires { field.is_rigid_body(); }) {
    if (needs == Needs::rigid_body && !field.is_rigid_body()) return "needs a rigid body whose inertia is known";
    if (needs == Needs::free_body && !(field.is_rigid_body() && field.torque_free())) return "needs a free rigid body";
  }
  if constexpr (requires { field.prescribed_rates(); })
    if (needs == Needs::prescribed_rates && !field.prescribed_rates())
      return "needs an attitude under prescribed rates (problem coning)";
  return "";
}

}  // namespace

std::string refusal_of(PreparedCell const& prepared) {
  std::string refusal = prepared.problem->refusal(prepared.cell.formulation);
  if (!refusal.empty()) return refusal;
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        MethodOn<M> const& method = method_named<M>(prepared.cell.integrator);
        refusal = method.refusal;
        if (refusal.empty()) refusal = problem_refusal<M>(method.info->needs, *field);
        if (refusal.empty())
          refusal = policy_refusal<M>(*method.info, prepared.plan.policy,
                                      std::holds_alternative<Adaptive>(prepared.plan.control));
      },
      problem);
  return refusal;
}

}  // namespace polhode::bench
