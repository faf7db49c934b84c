// The examples of problems/README.md and integrators/README.md do what they claim.
#include <cmath>
#include <cstdio>

#include "damped_body.hpp"
#include "heun.hpp"
#include "integrators/commutator_free.hpp"
#include "problems/jet.hpp"

namespace {

using namespace polhode;

static_assert(Definition<DampedBody>);

template <template <class> class A, class Method>
Quat<double> attitude_after_50_s(Method const& method, double h) {
  auto const body = DampedBody(Choice{}).field<double, A, true>();
  auto stepper = method.bind(body, FixedStep{h}, NormPolicy::none);
  auto x = body.initial();
  return stepper.advance(x, 0.0, 50.0) == Status::ok ? A<double>::attitude(x.first) : Quat<double>{};
}

/// log2 of the ratio of the errors at 0.1 s and 0.05 s.
template <template <class> class A, class Method>
double order(Method const& method) {
  Quat<double> const exact = attitude_after_50_s<S3>(CommutatorFree4{}, 0.005);
  double const coarse = angle_between(exact, attitude_after_50_s<A>(method, 0.1));
  double const fine = angle_between(exact, attitude_after_50_s<A>(method, 0.05));
  std::printf("%-12s order %.2f\n", Method::info.name.data(), std::log2(coarse / fine));
  return std::log2(coarse / fine);
}

/// The problem compiles as everything that the harness makes of it.
bool erases() {
  DampedBody const body{Choice{}};
  return erase<double, FlatQuaternion>(body) && erase<double, S3>(body) && erase<double, SO3>(body) &&
         erase<Quad, S3>(body) && erase<Jet<Quad, 32>, FlatQuaternion>(body);
}

}  // namespace

int main() {
  bool const good = erases() && std::fabs(order<FlatQuaternion>(Heun{}) - 2) < 0.1 &&
                    std::fabs(order<S3>(LieMidpoint{}) - 2) < 0.1 && std::fabs(order<SO3>(LieMidpoint{}) - 2) < 0.1;
  return good ? 0 : 1;
}
