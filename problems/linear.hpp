#pragma once
/// Dense linear equations in any scalar, on storage of fixed size: for the dozen unknowns that a field may have to
/// solve for.
#include <array>
#include <cstddef>
#include <utility>

#include "problems/scalar.hpp"

namespace polhode {

/// a x = b by elimination with partial pivoting; b becomes x, a is used up. a by rows. Pivots are chosen by value, of a
/// dual number or a power series by that of its constant term. Entries that are nothing cost nothing: most of them are
/// where few unknowns meet in an equation. Not finite if a is singular.
/// Source: Golub & Van Loan (2013), Matrix Computations, sec. 3.4
template <Scalar S, std::size_t n>
void solve(std::array<std::array<S, n>, n>& a, std::array<S, n>& b) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (abs_of(a[pivot][k]) < abs_of(a[i][k])) pivot = i;
    if (pivot != k) {
      std::swap(a[pivot], a[k]);
      std::swap(b[pivot], b[k]);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      if (is_nothing(a[i][k])) continue;
      S const factor = a[i][k] / a[k][k];
      for (std::size_t j = k + 1; j < n; ++j)
        if (!is_nothing(a[k][j])) a[i][j] = a[i][j] - factor * a[k][j];
      b[i] = b[i] - factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j)
      if (!is_nothing(a[k][j])) b[k] = b[k] - a[k][j] * b[j];
    b[k] = b[k] / a[k][k];
  }
}

}  // namespace polhode
