#pragma once
/// The Jacobian that implicit libraries ask for: the problem's own where it has one (problems/dual_field.hpp gives it),
/// else the library's difference quotients, which keep half the digits and cost an evaluation a column.
#include <span>

#include "integrators/rivals/library_field.hpp"

namespace polhode {

/// A problem that knows the derivative of its rate. Libraries ask it, and use difference quotients without.
///   has_jacobian()     false: this one does not, after all (its type was forgotten)
///   jacobian(t, x, J)  J[i + n j] = d rate_i / d x_j at (t, x): by columns, n numbers in a state
template <class P>
concept DifferentiableProblem = LibraryProblem<P> &&
    requires(P const& p, typename P::Space::Scalar t, Point<typename P::Space> const x, std::span<double> J) {
  { p.has_jacobian() } -> std::same_as<bool>;
  p.jacobian(t, x, J);
};
/// The Jacobian of a library's field at (t, y) into `columns`, n x n.
template <DifferentiableProblem P>
void write_jacobian(LibraryField<P> const& field, double t, double* y, double* columns) {
  auto const n = std::size_t(field.size());
  field.change(y,
               [&](Point<typename P::Space> const& x) { field.problem().jacobian(t, x, std::span(columns, n * n)); });
}

}  // namespace polhode
