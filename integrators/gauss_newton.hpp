#pragma once
/// Simplified Newton for the stage equations of collocation, where the fixed point diverges or crawls: h times the
/// Lipschitz constant of the field near 1 and above. One body; many have too large a matrix.
/// Source: Hairer & Wanner, Solving ODEs II, IV.8
#include <span>
#include <vector>

#include "integrators/fixed_point.hpp"
#include "integrators/gauss_tableau.hpp"
#include "problems/problem.hpp"

namespace polhode {

/// a x = b for several b, by rows, with partial pivoting: factored once, solved often, in double.
/// Source: Golub & Van Loan (2013), Matrix Computations, sec. 3.4
class FactoredMatrix {
 public:
  explicit FactoredMatrix(std::size_t n) : n_(n), a_(n * n), pivot_(n) {}

  double& operator()(std::size_t i, std::size_t j) { return a_[i * n_ + j]; }
  void factor() {
    for (std::size_t k = 0; k < n_; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < n_; ++i)
        if (std::fabs((*this)(pivot, k)) < std::fabs((*this)(i, k))) pivot = i;
      pivot_[k] = pivot;
      for (std::size_t j = 0; pivot != k && j < n_; ++j) std::swap((*this)(pivot, j), (*this)(k, j));
      for (std::size_t i = k + 1; i < n_; ++i) {
        double const factor = (*this)(i, k) /= (*this)(k, k);
        for (std::size_t j = k + 1; j < n_; ++j) (*this)(i, j) -= factor * (*this)(k, j);
      }
    }
  }
  /// b becomes x.
  void solve(std::span<double> b) {
    for (std::size_t k = 0; k < n_; ++k) std::swap(b[k], b[pivot_[k]]);
    for (std::size_t i = 1; i < n_; ++i)
      for (std::size_t j = 0; j < i; ++j) b[i] -= (*this)(i, j) * b[j];
    for (std::size_t i = n_; i-- > 0;) {
      for (std::size_t j = i + 1; j < n_; ++j) b[i] -= (*this)(i, j) * b[j];
      b[i] /= (*this)(i, i);
    }
  }

 private:
  std::size_t n_;
  std::vector<double> a_;
  std::vector<std::size_t> pivot_;
};

/// The equations of one step, Y_i = carry + sum_j mu_ij L_j with L_j = h b_j f(t + h c_j, Y_j): what Newton is told.
/// Y counts from x in the chart around it.
template <Space M>
struct StageEquations {
  using R = Real<typename M::Scalar>;
  std::span<Chart<M>> L, Y;
  GaussMu<R> const& table;
  Chart<M> const& carry;
};

/// For spaces on which there is no Newton: many bodies, and scalars that carry more than a number.
template <Space M>
class StageNewton {
 public:
  static constexpr bool possible = false;
  explicit StageNewton(int) {}
};
/// The matrix is I - h a (x) df/du, df/du by differences in the middle of the step: it steers the iteration and does
/// not enter its result. Linear algebra is in double for every scalar: a longer float takes a few iterations more.
template <SmallSpace M>
  requires std::is_arithmetic_v<typename M::Scalar> || std::same_as<typename M::Scalar, Quad>
class StageNewton<M> {
  using S = typename M::Scalar;
  using R = Real<S>;
  static constexpr std::size_t d = std::size_t(Chart<M>::size);

 public:
  static constexpr bool possible = true;
  explicit StageNewton(int stages)
      : stages_(std::size_t(stages)), matrix_(stages_ * d), change_(stages_ * d), jacobian_(d * d) {}

  /// Iterates from Y = carry until round-off. False if it comes to rest elsewhere, or nowhere.
  template <Problem P>
  bool solve(P const& p, S const& t, R const& h, Point<M> const& x, StageEquations<M> const& step,
             std::int64_t& iterations) {
    differentiate(p, S(t + R(0.5) * h), x);
    assemble(h, step);
    for (Chart<M>& one : step.Y) one = step.carry;
    Chart<M> most;
    fill(most, 0.0);
    // One measure for all components: the corrections never come to 0, and their parts go on finding new minima.
    AtRest<S> rest;
    for (int iteration = 0; iteration < most_iterations && !rest; ++iteration) {
      for (std::size_t i = 0; i < stages_; ++i) {
        Chart<M> here = M::centre(x);
        add(here, step.Y[i]);
        step.L[i] = M::chart_rate(x, here, p(S(t + h * step.table.c[i]), M::retract(x, here)));
        scale(step.L[i], R(h * step.table.b[i]));
      }
      ++iterations;
      correct(step, most);
      if (!all_finite(most)) return false;
      rest.see(largest<S>(most));
    }
    return is_solved(largest<S>(most), largest<S>(step.Y[0]));
  }

 private:
  static constexpr int most_iterations = 50;

  /// df/du at x, u in the chart around x.
  template <Problem P>
  void differentiate(P const& p, S const& t, Point<M> const& x) {
    Chart<M> const centre = M::centre(x), base = M::chart_rate(x, centre, p(t, x));
    std::array<S, d> at_base, here, beside;
    store(base, at_base.data());
    store(centre, here.data());
    for (std::size_t k = 0; k < d; ++k) {
      S const before = here[k];
      double const step = 0x1p-26 * std::max(1.0, std::fabs(double(before)));
      here[k] += S(step);
      Chart<M> u;
      load(u, here.data());
      store(M::chart_rate(x, u, p(t, M::retract(x, u))), beside.data());
      for (std::size_t i = 0; i < d; ++i) jacobian_[i * d + k] = double(beside[i] - at_base[i]) / step;
      here[k] = before;
    }
  }
  void assemble(R const& h, StageEquations<M> const& step) {
    for (std::size_t i = 0; i < stages_; ++i)
      for (std::size_t j = 0; j < stages_; ++j) {
        double const a = double(step.table.mu[i][j] * (h * step.table.b[j]));
        for (std::size_t k = 0; k < d; ++k)
          for (std::size_t m = 0; m < d; ++m)
            matrix_(i * d + k, j * d + m) = (i == j && k == m ? 1 : 0) - a * jacobian_[k * d + m];
      }
    matrix_.factor();
  }
  /// One correction of Y; `most` is its greatest size over stages, by component.
  void correct(StageEquations<M> const& step, Chart<M>& most) {
    for (std::size_t i = 0; i < stages_; ++i) {
      Chart<M> u = step.carry;
      for (std::size_t j = 0; j < stages_; ++j) add(u, step.table.mu[i][j], step.L[j]);
      double* out = &change_[i * d];
      Chart<M>::each([&](S const& wanted, S const& now) { *out++ = double(wanted - now); }, u, step.Y[i]);
    }
    matrix_.solve(change_);
    fill(most, 0.0);
    for (std::size_t i = 0; i < stages_; ++i) {
      double const* in = &change_[i * d];
      Chart<M>::each(
          [&](S& y, S& greatest) {
            S const change(*in++);
            y += change;
            // Not max_of: a number that is none must show.
            greatest = abs_of(change) < greatest ? greatest : abs_of(change);
          },
          step.Y[i], most);
    }
  }

  std::size_t stages_;
  FactoredMatrix matrix_;
  std::vector<double> change_, jacobian_;
};

}  // namespace polhode
