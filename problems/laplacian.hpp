#pragma once
/// The Laplacian of a digraph as a dense matrix, its left null vector and its spectrum: for some hundred nodes. What
/// solves is a template on its matrix, so that a unit compiles the solver that it calls alone, for seconds each.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <vector>

#include "problems/graph.hpp"

namespace polhode {

/// L_ii = sum_j a_ij, L_ij = -a_ij.   shape (nodes, nodes)
inline Eigen::MatrixXd laplacian(Graph const& graph) {
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(graph.nodes(), graph.nodes());
  for (int i = 0; i < graph.nodes(); ++i)
    graph.each_heard(i, [&](int j, double weight) {
      L(i, i) += weight;
      L(i, j) -= weight;
    });
  return L;
}
/// p with p^T L = 0 and sum 1; all positive if the graph is strongly connected with positive weights.
template <class Matrix = Eigen::MatrixXd>
std::vector<double> left_null_vector(Graph const& graph) {
  Matrix A = laplacian(graph).transpose();
  A.row(A.rows() - 1).setOnes();  // the equations sum to 0: one may be left out
  Eigen::VectorXd const p = A.partialPivLu().solve(Eigen::VectorXd::Unit(A.rows(), A.rows() - 1));
  return {p.data(), p.data() + p.size()};
}
/// The eigenvalues of an undirected graph's Laplacian, ascending: it is symmetric, so they are real.
template <class Matrix = Eigen::MatrixXd>
std::vector<double> undirected_spectrum(Graph const& graph) {
  Eigen::VectorXd const values =
      Eigen::SelfAdjointEigenSolver<Matrix>(laplacian(graph), Eigen::EigenvaluesOnly).eigenvalues();
  return {values.data(), values.data() + values.size()};
}

}  // namespace polhode
