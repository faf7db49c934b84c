#pragma once
/// Order conditions of products of exponentials, in quadruple precision: the coefficients of all ordered forests.
/// Source: Owren & Marthinsen (1999), BIT 39, 116; Iserles, Munthe-Kaas, Norsett & Zanna (2000), Acta Numerica 9, A.
#include <algorithm>
#include <array>
#include <vector>

#include "problems/scalar.hpp"

namespace polhode::test {

/// An ordered forest: the trees, each by the forest of its branches.
struct Forest {
  std::vector<Forest> branches;
  int nodes() const {
    int n = 0;
    for (Forest const& tree : branches) n += 1 + tree.nodes();
    return n;
  }
};
/// All ordered forests of n nodes.
inline std::vector<Forest> forests(int n) {
  if (n == 0) return {Forest{}};
  std::vector<Forest> all;
  for (int first = 1; first <= n; ++first)
    for (Forest const& tree : forests(first - 1))
      for (Forest const& rest : forests(n - first)) {
        Forest forest{{tree}};
        forest.branches.insert(forest.branches.end(), rest.branches.begin(), rest.branches.end());
        all.push_back(forest);
      }
  return all;
}
/// The exact solution's coefficient: the iterated integral over ascending times in [0, 1].
inline Quad exact_weight(Forest const& forest) {
  if (forest.branches.empty()) return 1;
  Forest earlier = forest;
  earlier.branches.pop_back();
  return exact_weight(earlier) * exact_weight(forest.branches.back()) / forest.nodes();
}

/// One exponential: the coefficients of the slopes.
using Factor = std::vector<Quad>;
/// Exponentials in the order in which they act.
using Factors = std::vector<Factor>;
/// A method: the exponentials that reach each stage from the start of the step, then those of the step.
using Scheme = std::vector<Factors>;

/// The coefficient of a forest in the point that stage i reaches.
inline Quad weight(Scheme const& scheme, std::size_t i, Forest const& forest) {
  std::size_t const n = forest.branches.size();
  std::vector<Quad> sum(n + 1);  // of the trees before the k-th, by the exponentials so far
  sum[0] = 1;
  for (Factor const& factor : scheme[i]) {
    std::vector<Quad> tree(n);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < factor.size(); ++j)
        if (factor[j] != 0) tree[k] += factor[j] * weight(scheme, j, forest.branches[k]);
    std::vector<Quad> next(n + 1);
    for (std::size_t from = 0; from <= n; ++from) {
      Quad term = sum[from];
      for (std::size_t to = from; to <= n; ++to) {  // exp: the trees from .. to - 1, over their factorial
        next[to] += term;
        if (to < n) term = term * tree[to] / int(to - from + 1);
      }
    }
    sum = next;
  }
  return sum[n];
}

/// What the step lacks in every condition of an order.
inline std::vector<Quad> defects(Scheme const& scheme, std::size_t step, int order) {
  std::vector<Quad> all;
  for (Forest const& forest : forests(order)) all.push_back(weight(scheme, step, forest) - exact_weight(forest));
  return all;
}
/// The greatest defect up to an order.
inline double greatest_defect(Scheme const& scheme, std::size_t step, int order) {
  double most = 0;
  for (int p = 1; p <= order; ++p)
    for (Quad const& d : defects(scheme, step, p)) most = std::max(most, double(fabsq(d)));
  return most;
}

/// The scheme of a tableau (exponentials.hpp), with every product written out from the start of the step.
template <class T>
Scheme scheme_of() {
  Scheme scheme{{}};
  for (auto const& product : T::product) {
    Factors factors = product.from_second ? scheme[1] : Factors{};
    for (int e = 0; e < product.count; ++e) {
      auto const& row = product.factor[std::size_t(e)];
      factors.emplace_back(row.begin(), row.end());
    }
    scheme.push_back(factors);
  }
  return scheme;
}

}  // namespace polhode::test
