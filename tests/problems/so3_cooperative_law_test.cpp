/// The laws of cooperative craft on SO(3): linear equations, the command and its derivatives, surfaces, the closure.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "problems/dual.hpp"
#include "problems/so3_cooperative.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::in;
using test::Random;
using D1 = Dual<1>;
using test::expect_near;
using test::Numbers;
using test::Real3;
using test::Words;
using Rates = Many<Pair<Real3, Real3>, dynamic>;

constexpr test::Chooser<So3Cooperative> chosen;
/// v as it moves with velocity `rate`.
Vec3<D1> moving(Real3 const& v, Real3 const& rate) {
  D1 s(0.0);
  s.slope[0] = 1;
  Vec3<D1> moved = in<D1>(v);
  add(moved, s, in<D1>(rate));
  return moved;
}
Mat3<D1> turning(Mat3<double> const& R, Real3 const& omega) {
  Mat3<double> const rate = FlatRotation<double>::rate(R, omega);
  return {moving(R.e1, rate.e1), moving(R.e2, rate.e2), moving(R.e3, rate.e3)};
}
Real3 value_of(Vec3<D1> const& v) {
  return {v.x.value, v.y.value, v.z.value};
}
Real3 slope_of(Vec3<D1> const& v) {
  return {v.x.slope[0], v.y.slope[0], v.z.slope[0]};
}
/// Random attitudes, and rates of up to `speed` an axis [rad/s].
template <class State>
State random_state(Random& random, State x, double speed) {
  for (int i = 0; i < cooperative_craft; ++i) x[i] = {matrix(random.attitude()), random.vector(speed)};
  return x;
}

// ---- Parts ----------------------------------------------------------------------------------------------------------

TEST(LinearEquations, AreSolvedInEveryScalar) {
  Random random(1);
  std::array<std::array<double, 15>, 15> A;
  std::array<std::array<Quad, 15>, 15> long_A;
  std::array<std::array<D1, 15>, 15> dual_A;
  std::array<double, 15> b;
  std::array<Quad, 15> long_b;
  std::array<D1, 15> dual_b;
  Eigen::MatrixXd matrix(15, 15);
  Eigen::VectorXd right(15);
  for (std::size_t i = 0; i < 15; ++i) {
    for (std::size_t j = 0; j < 15; ++j) {
      double const a = random.uniform(-1, 1);
      matrix(int(i), int(j)) = A[i][j] = a;
      long_A[i][j] = Quad(a);
      dual_A[i][j] = D1(a);
    }
    right(int(i)) = b[i] = random.uniform(-1, 1);
    long_b[i] = Quad(b[i]);
    dual_b[i] = D1::of(b[i], [&](std::size_t) { return i == 3 ? 1.0 : 0.0; });
  }
  solve(A, b);
  solve(long_A, long_b);
  solve(dual_A, dual_b);
  Eigen::VectorXd const x = matrix.partialPivLu().solve(right);
  Eigen::VectorXd const column = matrix.partialPivLu().solve(Eigen::VectorXd::Unit(15, 3));
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_NEAR(b[i], x(int(i)), 1e-12);
    EXPECT_NEAR(double(long_b[i]), x(int(i)), 1e-12);
    EXPECT_NEAR(dual_b[i].slope[0], column(int(i)), 1e-12);
  }
  std::array<std::array<double, 2>, 2> swapped{{{0, 2}, {4, 0}}};
  std::array<double, 2> y{6, 8};
  solve(swapped, y);
  EXPECT_EQ(y[0], 2) << "needs a pivot";
  EXPECT_EQ(y[1], 3);
}

TEST(SmoothedPower, HasItsSlopeAndTendsToTheRoot) {
  for (double s : {-2.0, -0.05, 0.0, 1e-4, 0.3}) {
    Vec3<D1> const at = moving({s, 0, 0}, {1, 0, 0});
    EXPECT_NEAR(smoothed_power(at, 0.1).value.x.slope[0], smoothed_power(Real3{s, 0, 0}, 0.1).slope.x, 1e-14) << s;
    EXPECT_NEAR(smoothed_power(Real3{s, 0, 0}, 0.0).value.x, std::copysign(std::sqrt(std::fabs(s)), s), 1e-15) << s;
  }
  EXPECT_NEAR(smoothed_power(Real3{0, 0, 0}, 0.01).slope.x, 10, 1e-13) << "delta^(-1/2)";
}

TEST(AngleOverSine, IsSmoothAndExactInLongFloats) {
  EXPECT_EQ(angle_over_sine(0.0, 1.0), 1);
  for (double angle : {1e-8, 1e-3, 0.1, 0.121, 0.1224, 0.1225, 0.123, 0.2, 1.5, 2.0, 3.1}) {
    Quad const sine = sin(Quad(angle)), cosine = cos(Quad(angle)), exact = Quad(angle) / sine;
    for (Quad const scale : {Quad(1.0), Quad(1.0 + 1e-5)}) {  // both drifted alike: still the angle over the sine
      Quad const got = angle_over_sine(Quad(scale * scale * sine * sine), Quad(scale * cosine));
      EXPECT_LE(double(fabsq(got * scale / exact - 1)), 1e-32) << angle;
    }
    EXPECT_NEAR(angle_over_sine(double(sine * sine), double(cosine)) / double(exact), 1, 2e-15) << angle;
  }
}

// ---- The command ----------------------------------------------------------------------------------------------------

TEST(CooperativeCommand, DerivativesByDualNumbers) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    HeardAxes<double> heard;
    HeardAxes<D1> moved;
    std::array<double, 3> const weight{0.5, 0.3, 0.2};
    std::array<Mat3<double>, 3> R;
    std::array<Real3, 3> omega, change;
    for (std::size_t j = 0; j < 3; ++j) {
      R[j] = matrix(random.attitude());
      omega[j] = random.vector(1);
      change[j] = random.vector(1);
      heard.hear(weight[j], R[j], omega[j]);
      moved.hear(weight[j], turning(R[j], omega[j]), moving(omega[j], change[j]));
    }
    CooperativeCommand<double> const command(heard);
    CooperativeCommand<D1> const later(moved);
    if (command.n1 < 0.1 || command.n3 < 0.03) continue;
    EXPECT_LE(double(OrthogonalMatrix<double>::defect(command.attitude)), 2e-15);
    Mat3<double> const rate = FlatRotation<double>::rate(command.attitude, command.rate);
    expect_near(slope_of(later.attitude.e1), rate.e1, 1e-12, "R_d' = R_d hat(Omega_d)");
    expect_near(slope_of(later.attitude.e2), rate.e2, 1e-12);
    expect_near(slope_of(later.attitude.e3), rate.e3, 1e-12);
    Real3 wanted = command.drift;
    for (std::size_t j = 0; j < 3; ++j) add(wanted, command.response(weight[j], R[j]) * change[j]);
    expect_near(slope_of(later.rate), wanted, 1e-10 * (1 + length(wanted)), "Omega_d' = n_d + D Omega'");
  }
}

/// |v1| >= |a - b| and |v1 x v2| >= (a - b)^2 of two weights: .19 / .61 for craft 4, printed graph.
TEST(CooperativeCommand, CannotDegenerateOnThePrintedGraph) {
  Random random(3);
  auto const field = chosen.field<FlatRotation>({});
  double const bound = 0.19 / 0.61;
  EXPECT_NEAR(bound, 0.3115, 5e-5);
  EXPECT_NEAR(bound * bound, 0.097, 5e-5);
  double least1 = 1, least3 = 1;
  for (int trial = 0; trial < 20000; ++trial) {
    auto const x = random_state(random, field.initial(), 0);
    auto const R = field.rotations(x);
    for (std::size_t i = 0; i < 5; ++i) {
      auto const command = field.command(i, x, R);
      least1 = std::min(least1, command.n1);
      least3 = std::min(least3, command.n3);
    }
  }
  EXPECT_GE(least1, bound * (1 - 1e-12));
  EXPECT_GE(least3, bound * bound * (1 - 1e-12));
  EXPECT_LE(least1, 0.32);
  EXPECT_LE(least3, 0.10);
}

// ---- Surfaces -------------------------------------------------------------------------------------------------------

using enum CooperativeSurface;
constexpr std::array surfaces{far, near, quaternion, mrp};

/// Of a craft at attitude Q and rate omega whose command rests at 1.
template <class S>
CooperativeErrors<S> against_rest(Mat3<S> const& Q, Vec3<S> const& omega) {
  HeardAxes<S> heard;
  S const zero(0.0), one(1.0);
  heard.hear(1.0, {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}, {zero, zero, zero});
  return {Q, omega, CooperativeCommand<S>(heard), 0.8};
}

TEST(CooperativeSurfaces, AlphaRateByDualNumbers) {
  Random random(4);
  for (CooperativeSurface surface : surfaces)
    for (int trial = 0; trial < 60; ++trial) {
      double const most = surface == near ? 1.4 : 3.0, least = trial < 20 ? 1e-4 : 0.2;
      Mat3<double> const Q =
          matrix(exp_quaternion(random.uniform(least, trial < 20 ? 0.2 : most) * random.direction()));
      Real3 const e = random.vector(1);
      for (double delta : {0.1, 0.01}) {
        CooperativeGains const gains{.delta = delta};
        auto const at = CooperativeLaw<double>(gains, true).virtual_control(surface, against_rest(Q, e));
        auto const later =
            CooperativeLaw<D1>(gains, true).virtual_control(surface, against_rest(turning(Q, e), in<D1>(e)));
        expect_near(value_of(later.alpha), at.alpha, 1e-12 * (1 + length(at.alpha)));
        expect_near(slope_of(later.alpha), at.alpha_rate, 1e-10 * (1 + length(at.alpha_rate)), std::to_string(trial));
      }
    }
}

TEST(CooperativeSurfaces, AreTheVectorsTheyAreNamedAfter) {
  Real3 const u = 1.2 * Real3{0.6, 0, -0.8};
  Quat<double> const q = exp_quaternion(u);
  CooperativeLaw<double> const law({}, true), without({}, false);
  for (double sign : {1.0, -1.0}) {
    auto const e = against_rest(matrix(scaled(sign, q)), Real3{0, 0, 0});
    expect_near(law.virtual_control(far, e).s1, u, 1e-15);
    expect_near(law.virtual_control(near, e).s1, std::sin(1.2) / 1.2 * u, 1e-15);
    expect_near(law.virtual_control(quaternion, e).s1, 2 * std::sin(0.6) / 1.2 * u, 1e-15);
    expect_near(law.virtual_control(mrp, e).s1, 4 * std::tan(0.3) / 1.2 * u, 1e-15);
    expect_near(law.virtual_control(mrp, e).cross_term, 4 * std::tan(0.3) / 1.2 * u, 1e-15);
    expect_near(without.virtual_control(mrp, e).cross_term, {0, 0, 0}, 0);
  }
}

/// C = 1/2 (tr(P) - P) has determinant cos(theta) cos^2(theta / 2); C alpha = -g, X = C^T e_R.
TEST(CooperativeSurfaces, NearIsSingularAt90And180Degrees) {
  Random random(5);
  CooperativeLaw<double> const law({}, true);
  for (double angle : {0.3, 1.0, 1.5, 1.57, 2.5}) {
    auto const e = against_rest(matrix(exp_quaternion(angle * random.direction())), random.vector(1));
    Eigen::Matrix3d C;
    for (int i = 0; i < 3; ++i) {
      Real3 const& row = i == 0 ? e.Q.e1 : i == 1 ? e.Q.e2 : e.Q.e3;
      C.row(i) = -0.5 * Eigen::RowVector3d(row.x, row.y, row.z);
      C(i, i) += 0.5 * e.trace();
    }
    EXPECT_NEAR(C.determinant(), std::cos(angle) * std::pow(std::cos(angle / 2), 2), 1e-14) << angle;
    auto const control = law.virtual_control(near, e);
    Eigen::Vector3d const alpha(control.alpha.x, control.alpha.y, control.alpha.z), s(e.e_R.x, e.e_R.y, e.e_R.z);
    Eigen::Vector3d const g = C * alpha, X = C.transpose() * s;
    expect_near({g.x(), g.y(), g.z()}, -1.15 * e.e_R - 0.03 * smoothed_power(e.e_R, 0.1).value, 1e-13);
    expect_near(control.cross_term, {X.x(), X.y(), X.z()}, 1e-15);
  }
}

/// Without the powers, near a command at rest: u'' + 1.3 u' + 1.1725 u = 0.
TEST(CooperativeSurfaces, Linearisation) {
  using D6 = Dual<6>;
  auto const seeded = [](std::size_t first) {
    Vec3<D6> v;
    for (D6* a : {&v.x, &v.y, &v.z}) a->slope[first++] = 1;
    return v;
  };
  Vec3<D6> const u = seeded(0), omega = seeded(3);
  D6 const one(1.0);
  Mat3<D6> const Q{{one, u.z, -u.y}, {-u.z, one, u.x}, {u.y, -u.x, one}};
  CooperativeLaw<D6> const law({.p1 = 0, .p2 = 0}, true);
  for (CooperativeSurface surface : surfaces) {
    auto const e = against_rest(Q, omega);
    Vec3<D6> const change = law.wanted(law.virtual_control(surface, e), e.omega);
    std::array<D6, 3> const rows{change.x, change.y, change.z};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 6; ++k)
        EXPECT_NEAR(rows[i].slope[k], k == i ? -1.1725 : k == i + 3 ? -1.3 : 0, 1e-14) << i << ", " << k;
  }
}

// ---- The closure ----------------------------------------------------------------------------------------------------

/// e_Omega' is what the law wants, whatever turns. s2' = -K2 s2 - P2 phi(s2) - X where those that are heard rest at the
/// moment; otherwise alpha' of the law is that of Q' = Q hat(e_Omega), and s2' has the rest of alpha'.
TEST(CooperativeClosure, BySolvingForAllAccelerations) {
  Random random(6);
  struct Kind {
    Words words;
    CooperativeSurface surface;
  };
  for (Kind const& kind : {Kind{{}, far}, Kind{{"near"}, near}, Kind{{"method2"}, quaternion}, Kind{{"method3"}, mrp}})
    for (int trial = 0; trial < 20; ++trial) {
      auto const field = chosen.field<FlatRotation>(kind.words);
      auto const dual = chosen.field<FlatRotation, D1>(kind.words);
      bool const resting = trial < 10;
      auto const x = random_state(random, field.initial(), resting ? 0 : 0.5);
      Rates v(5);
      field(0, x, v);
      auto moved = dual.initial();
      for (int i = 0; i < 5; ++i) moved[i] = {turning(x[i].first, x[i].second), moving(x[i].second, v[i].second)};
      auto const R = field.rotations(x);
      auto const moved_R = dual.rotations(moved);
      for (std::size_t i = 0; i < 5; ++i) {
        auto const e = field.errors(i, x, R, field.command(i, x, R));
        auto const later = dual.errors(i, moved, moved_R, dual.command(i, moved, moved_R));
        auto const control = field.law.virtual_control(kind.surface, e);
        if (length(control.alpha) > 50) continue;  // `near` close to a singularity
        double const scale = 1 + length(control.alpha_rate) + length(control.alpha);
        expect_near(slope_of(later.omega), field.law.wanted(control, e.omega), 1e-9 * scale, "e_Omega'");

        auto true_error = e;
        true_error.omega = e.omega - 0.25 * e.fed;  // Omega - P Omega_d = e_Omega - (1 - rho) / rho fed
        auto const truly = field.law.virtual_control(kind.surface, true_error);
        Vec3<D1> const s2 = later.omega - dual.law.virtual_control(kind.surface, later).alpha;
        Real3 const at = value_of(s2);
        Real3 const wanted = -0.15 * at - 0.03 * smoothed_power(at, 0.1).value - control.cross_term;
        Real3 const rest = control.alpha_rate - truly.alpha_rate;
        if (resting) {
          EXPECT_EQ(length(rest), 0);
        }
        expect_near(slope_of(s2), wanted + rest, 1e-9 * scale, "s2'");
      }
    }
}

/// P D over all craft.
template <class Field, class State>
Eigen::MatrixXd coupling(Field const& field, State const& x) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(15, 15);
  auto const R = field.rotations(x);
  for (int i = 0; i < 5; ++i) {
    auto const command = field.command(std::size_t(i), x, R);
    auto const e = field.errors(std::size_t(i), x, R, command);
    field.graph.each_heard(i, [&](int j, double a) {
      auto const D = command.response(a, R[std::size_t(j)]);
      int column = 3 * j;
      for (Real3 const& one : {D.e1, D.e2, D.e3}) {
        Real3 const seen = transposed_times(e.Q, one);
        all.col(column++).segment<3>(3 * i) = Eigen::Vector3d(seen.x, seen.y, seen.z);
      }
    });
  }
  return all;
}
double radius(Eigen::MatrixXd const& m) {
  return m.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(CooperativeClosure, AFixedPointWouldDiverge) {
  Random random(7);
  auto const field = chosen.field<FlatRotation>({});
  double most = 0;
  for (int trial = 0; trial < 4000; ++trial)
    most = std::max(most, radius(coupling(field, random_state(random, field.initial(), 0))));
  EXPECT_GT(0.8 * most, 1.05) << "sweeps with rho = .8 move away from the solution";
  EXPECT_NEAR(most, 1.33, 0.01);
  auto together = field.initial();
  for (int i = 1; i < 5; ++i) together[i].first = together[0].first;
  EXPECT_NEAR(std::fabs((Eigen::MatrixXd::Identity(15, 15) - coupling(field, together)).determinant()), 0, 1e-14)
      << "rho = 1 has no solution";
  EXPECT_NEAR(radius(coupling(field, field.initial())), 1, 1e-3) << "EX1: sweeps would do";
  auto const large = chosen.field<FlatRotation>({"ex2"});
  EXPECT_NEAR(radius(coupling(large, large.initial())), 1.242, 1e-3);
}

}  // namespace
}  // namespace polhode
