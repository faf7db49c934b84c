// A user of the core: a free body by two methods, the norm and the attitude checked against printed digits.
#include <cstdio>

#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/free_body.hpp"

namespace {

using namespace polhode;

/// How far `method` ends from the known attitude of the body at 50 s, on attitude space A [rad].
template <template <class> class A, class Method>
double error_after_50_s(Method const& method) {
  auto const body = FreeBody(Choice{}).field<double, A, true>();
  auto stepper = method.bind(body, FixedStep{.h = 0.01}, NormPolicy::none);
  auto x = body.initial();
  Status const status = stepper.advance(x, 0.0, 50.0);
  Quat<double> const known{0.5621467036241, 0.8003003665559, -0.1114552884275, -0.1763182508325};
  double const error = angle_between(known, A<double>::attitude(x.first));
  bool const good = status == Status::ok && error < 1e-11 && A<double>::defect(x.first) < 1e-12;
  std::printf("%-5s %.1e rad, norm %.1e\n", Method::info.name.data(), error, A<double>::defect(x.first));
  return good ? error : 1;
}

}  // namespace

int main() {
  return error_after_50_s<FlatQuaternion>(Rk4{}) < 1 && error_after_50_s<S3>(CommutatorFree4{}) < 1 ? 0 : 1;
}
