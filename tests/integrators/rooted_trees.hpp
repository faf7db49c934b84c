#pragma once
/// Rooted trees, and the order conditions of Runge-Kutta methods that they stand for, in quadruple precision.
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.2
#include <algorithm>
#include <vector>

#include "problems/scalar.hpp"

namespace polhode::test {

using Row = std::vector<Quad>;
using Matrix = std::vector<Row>;

/// A tree by the trees that hang from its root, as places in a list.
struct Tree {
  std::vector<std::size_t> children;
  int order = 1;
  Quad density = 1;  ///< gamma
};

/// All trees up to the given order, by order: 1, 1, 2, 4, 9, 20, 48, 115, 286, 719, ...
inline std::vector<Tree> rooted_trees(int highest) {
  std::vector<Tree> trees;
  std::vector<std::size_t> children;
  // Children in descending order of place, so that each set of them comes once.
  auto const hang = [&](auto const& again, int left, std::size_t last, int order) -> void {
    if (left == 0) {
      Tree tree{children, order, Quad(order)};
      for (std::size_t child : children) tree.density *= trees[child].density;
      trees.push_back(tree);
      return;
    }
    for (std::size_t place = 0; place <= last && place < trees.size(); ++place) {
      if (trees[place].order > left) break;
      children.push_back(place);
      again(again, left - trees[place].order, place, order);
      children.pop_back();
    }
  };
  for (int order = 1; order <= highest; ++order) hang(hang, order - 1, trees.empty() ? 0 : trees.size() - 1, order);
  return trees;
}

/// The conditions on weights at the stages of the matrix `a`.
class OrderConditions {
 public:
  OrderConditions(Matrix const& a, int highest) : trees_(rooted_trees(highest)) {
    for (Tree const& tree : trees_) {
      Row values(a.size(), Quad(1));
      for (std::size_t child : tree.children)
        for (std::size_t i = 0; i < a.size(); ++i) values[i] *= dot(a[i], values_[child]);
      values_.push_back(values);
    }
  }
  /// Greatest |b . Phi(t) - s^order / gamma(t)| over the trees of this order: 0 if b gives the solution at the part s
  /// of a step. At s = 0 the weights of an error estimate.
  double defect(Row const& b, int order, Quad s = 1) const {
    Quad power = 1, worst = 0;
    for (int k = 0; k < order; ++k) power *= s;
    for (std::size_t t = 0; t < trees_.size(); ++t)
      if (trees_[t].order == order)
        worst = std::max(worst, Quad(fabsq(dot(b, values_[t]) - power / trees_[t].density)));
    return double(worst);
  }
  /// The same over all orders up to this one.
  double defect_up_to(Row const& b, int order, Quad s = 1) const {
    double worst = 0;
    for (int k = 1; k <= order; ++k) worst = std::max(worst, defect(b, k, s));
    return worst;
  }
  /// How many conditions there are.
  std::size_t size() const { return trees_.size(); }

 private:
  /// Rows may be shorter than there are stages: zeros follow.
  static Quad dot(Row const& a, Row const& b) {
    Quad sum = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += a[i] * b[i];
    return sum;
  }

  std::vector<Tree> trees_;
  Matrix values_;  ///< Phi_i, by tree
};

/// A table of coefficients in quadruple precision.
template <class C, std::size_t n>
Row in_quad(C const (&row)[n]) {
  Row values;
  for (C const& coefficient : row) values.push_back(coefficient.template as<Quad>());
  return values;
}
template <class C, std::size_t n, std::size_t m>
Matrix in_quad(C const (&table)[n][m]) {
  Matrix rows;
  for (auto const& row : table) rows.push_back(in_quad(row));
  return rows;
}
/// The matrix of a pair with the slope at the step's end as one more stage, and those of its continuous extension.
template <class T>
Matrix all_stages() {
  Matrix a = in_quad(T::a);
  a.push_back(in_quad(T::b));
  if constexpr (requires { T::dense_a; })
    for (Row const& row : in_quad(T::dense_a)) a.push_back(row);
  return a;
}

}  // namespace polhode::test
