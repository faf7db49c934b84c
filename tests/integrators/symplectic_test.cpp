/// Symplecticity in the whole phase space of a rigid body, attitude and angular momentum, in quadruple precision:
/// whoever claims it has it, and who does not, lacks it. Walks the catalogue's list of methods for a body.
#include <gtest/gtest.h>

#include "integrators/catalog/body.hpp"
#include "integrators/gauss_canonical.hpp"
#include "problems/erased.hpp"
#include "tests/support/splitting_runs.hpp"

namespace polhode {
namespace {

using V = Vec3<Quad>;
using Body = Erased<RigidBody<S3<Quad>>>;
using State = Point<RigidBody<S3<Quad>>>;

/// A free body, or, for methods that accept a torque, a top under a weight that swings in time.
std::unique_ptr<Body> body_for(Needs needs) {
  if (needs == Needs::free_body) return erase_type(controlled_body<Quad, S3, true>(test::top(), NoTorque<Quad>{}));
  return erase_type(test::top_under<Quad, S3>({.shaken = true}));
}

/// By how much a step of h [s] changes the canonical form dL_1.xi_2 - dL_2.xi_1 - L.(xi_1 x xi_2) of two variations, xi
/// of the attitude [rad] and dL of the angular momentum, both in body axes; by central differences. Null if it fails.
template <class Method>
std::optional<double> change_of_form(Body const& body, double h) {
  struct Variation {
    V xi, omega;
  };
  Mat3<Quad> const J = body.inertia_matrix();
  bool failed = false;
  auto const stepped = [&](State x) {
    failed |= Method{}.bind(body, FixedStep{h}, NormPolicy::none).advance(x, 0, Quad(h)) != Status::ok;
    return x;
  };
  auto const form = [&](Variation const& a, Variation const& b, V const& omega) {
    return dot(J * a.omega, b.xi) - dot(J * b.omega, a.xi) - dot(J * omega, cross(a.xi, b.xi));
  };
  State const start = body.initial(), end = stepped(start);
  auto const after = [&](Variation const& d) {
    Quad const small(1e-9), half = Quad(0.5) / small;
    auto const beside = [&](Quad const& e) {
      return stepped({S3<Quad>::retract(start.first, e * d.xi), start.second + e * d.omega});
    };
    auto const right = beside(small), left = beside(-small);
    return Variation{half * (S3<Quad>::local(end.first, right.first) - S3<Quad>::local(end.first, left.first)),
                     half * (right.second - left.second)};
  };
  double most = 0;
  Variation const variations[]{
      {{.3, -.5, .7}, {.2, .9, -.4}}, {{-.6, .1, .4}, {.5, -.3, .8}}, {{.2, .8, .1}, {-.7, .4, .6}}};
  for (Variation const& a : variations)
    for (Variation const& b : variations)
      most = std::max(most, std::fabs(double(form(after(a), after(b), end.second) - form(a, b, start.second))));
  if (failed) return {};
  return most;
}

constexpr double round_off_of_differences = 1e-15, least_change = 1e-9;

template <class Method>
void expect_symplectic_as_claimed() {
  constexpr auto const& info = Method::info;
  auto const change = change_of_form<Method>(*body_for(info.needs), 0.5);
  ASSERT_TRUE(change) << info.name;
  if (info.preserves & is_symplectic) {
    EXPECT_LT(*change, round_off_of_differences) << info.name << " claims to be symplectic";
  } else {
    EXPECT_GT(*change, least_change) << info.name << " is symplectic: a claim is missing";
  }
}
/// How many of a list have been checked: methods for one rigid body.
template <class... Method>
int expect_symplectic_as_claimed(Types<Method...>) {
  int checked = 0;
  auto const one = [&]<class M>(M) {
    if constexpr (RunsFixed<M, Body>) {
      expect_symplectic_as_claimed<M>();
      ++checked;
    }
  };
  (one(Method{}), ...);
  return checked;
}

TEST(Symplectic, AreTheMethodsForABodyThatClaimIt) {
  EXPECT_GE(expect_symplectic_as_claimed(BodyMethods{}), 14);
}
TEST(Symplectic, IsGaussInCanonicalVariables) {
  expect_symplectic_as_claimed(Types<GaussCanonical<1>, GaussCanonical<2>, GaussCanonical<4>>{});
}
TEST(Symplectic, IsNotGaussOnRatesNorAnExplicitMethod) {
  expect_symplectic_as_claimed(Types<GaussEntry<1>, GaussEntry<2>, GaussEntry<4>>{});
}

}  // namespace
}  // namespace polhode
