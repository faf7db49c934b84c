/// Graphs: rows from triples, files, the rules that a user's graph can break, seeded digraphs, spectra; the two
/// protocols and the consensus torque by hand.
#include "problems/graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "problems/controllers/consensus.hpp"
#include "problems/controllers/synchronisation.hpp"
#include "problems/laplacian.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::expect_near;
using test::Random;
using testing::DoubleNear;
using testing::Pointwise;

std::string graph_complaint(std::vector<double> const& triples, int nodes) {
  return test::complaint_of<ParameterError>([&] { graph_of(triples, nodes); });
}
/// (i, j, a_ij) of node i, counted from 0.
std::set<std::pair<int, double>> heard_by(Graph const& graph, int i) {
  std::set<std::pair<int, double>> all;
  graph.each_heard(i, [&](int j, double weight) { all.insert({j, weight}); });
  return all;
}
using Heard = std::set<std::pair<int, double>>;

/// Meng, San & Zhang (2022): five spacecraft.
std::vector<double> const paper{1, 2, 1, 1, 5, 1, 2, 3, 1, 2, 4, 1, 3, 4, 1, 4, 1, 1, 5, 4, 1};

// ---- Making graphs --------------------------------------------------------------------------------------------------

TEST(Graph, RowsInAnyOrderOfTheTriples) {
  Graph const graph = graph_of({3, 1, 0.5, 1, 2, -1, 3, 2, 2}, 4);
  EXPECT_EQ(graph.nodes(), 4);
  EXPECT_EQ(graph.links(), 3);
  EXPECT_EQ(heard_by(graph, 0), (Heard{{1, -1}}));
  EXPECT_EQ(heard_by(graph, 1), Heard{});
  EXPECT_EQ(heard_by(graph, 2), (Heard{{0, 0.5}, {1, 2}}));
  EXPECT_EQ(heard_by(graph, 3), Heard{});
}

TEST(Graph, UndirectedLinksAreWrittenOnce) {
  Graph const graph = undirected_graph_of({1, 2, 3, 2, 3, -1}, 3);
  EXPECT_EQ(heard_by(graph, 0), (Heard{{1, 3}}));
  EXPECT_EQ(heard_by(graph, 1), (Heard{{0, 3}, {2, -1}}));
  EXPECT_EQ(heard_by(graph, 2), (Heard{{1, -1}}));
  EXPECT_EQ(test::complaint_of<ParameterError>([] {
              undirected_graph_of({1, 2, 3, 2, 1, 3}, 3);
            }),
            "parameter graph: node 1 hears node 2 twice");
}

TEST(Graph, EveryBrokenRuleIsNamed) {
  double const inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(graph_complaint(paper, 5), "");
  EXPECT_EQ(graph_complaint({1, 2}, 2), "parameter graph: takes 3 numbers a link (node, node that it hears, weight)");
  EXPECT_EQ(graph_complaint({0, 2, 1}, 2), "parameter graph: nodes are whole numbers from 1, not 0");
  EXPECT_EQ(graph_complaint({1, -2, 1}, 2), "parameter graph: nodes are whole numbers from 1, not -2");
  EXPECT_EQ(graph_complaint({1.5, 2, 1}, 2), "parameter graph: nodes are whole numbers from 1, not 1.5");
  EXPECT_EQ(graph_complaint({1, nan, 1}, 2), "parameter graph: nodes are whole numbers from 1, not nan");
  EXPECT_EQ(graph_complaint({1, 1e300, 1}, 2), "parameter graph: nodes are whole numbers from 1, not 1e+300");
  EXPECT_EQ(graph_complaint({1, 2, 1, 3, 1, 1}, 2), "parameter graph: node 3 does not exist: there are 2");
  EXPECT_EQ(graph_complaint({2, 2, 1}, 2), "parameter graph: node 2 must not hear itself");
  EXPECT_EQ(graph_complaint({1, 2, inf}, 2), "parameter graph: the weight of node 1 hearing node 2 must be finite");
  EXPECT_EQ(graph_complaint({1, 2, 0}, 2), "parameter graph: the weight of node 1 hearing node 2 must not be 0");
  EXPECT_EQ(graph_complaint({2, 1, 1, 1, 2, 1, 2, 1, 3}, 2), "parameter graph: node 2 hears node 1 twice");
}

TEST(Graph, TheParameterTakesThreeNumbersALink) {
  std::vector<double> triples = paper;
  Parameter graph("graph", "", Rule::graph, triples);
  graph.assign({1, 2, 1, 2, 1, 1});
  EXPECT_EQ(triples, (std::vector<double>{1, 2, 1, 2, 1, 1}));
  for (std::vector<double> const& wrong : {std::vector<double>{}, {1, 2, 1, 2}, {1}}) {
    EXPECT_EQ(test::complaint_of<ParameterError>([&] { graph.assign(wrong); }),
              "parameter graph: takes 3 numbers a link (node, node that it hears, weight), not " +
                  std::to_string(wrong.size()));
    EXPECT_EQ(triples.size(), 6u) << "a refused value must not stick";
  }
  EXPECT_EQ(test::complaint_of<ParameterError>([&] {
              graph.assign({1, 2, std::nan("")});
            }),
            "parameter graph: every number must be finite");
}

// ---- Files ----------------------------------------------------------------------------------------------------------

std::vector<double> read(std::string const& text) {
  std::istringstream in(text);
  return read_graph(in, "swarm.txt");
}
/// What read_graph has against a text, without the file's name.
std::string file_complaint(std::string const& text) {
  std::string const what = test::complaint_of<ParameterError>([&] { read(text); });
  std::string const prefix = "parameter graph: swarm.txt";
  EXPECT_TRUE(what.empty() || what.starts_with(prefix)) << what;
  return what.empty() ? "" : what.substr(prefix.size());
}

TEST(GraphFile, LinesAndComments) {
  EXPECT_EQ(read("# two craft\n\n1 2 1.5   # hears\n\t2\t1  1e-3\r\n   # end"),
            (std::vector<double>{1, 2, 1.5, 2, 1, 1e-3}));
}

TEST(GraphFile, ComplaintsHaveFileAndLine) {
  EXPECT_EQ(file_complaint("1 2 1\n# x\n1 2\n"), ":3: a link is `i j weight`, not 2 number(s)");
  EXPECT_EQ(file_complaint("1 2 1 4\n"), ":1: a link is `i j weight`, not 4 number(s)");
  EXPECT_EQ(file_complaint("1 2 one\n"), ":1: not a number: one");
  EXPECT_EQ(file_complaint("1 2 1x\n"), ":1: not a number: 1x");
  EXPECT_EQ(file_complaint("1 2 1e999\n"), ":1: out of range: 1e999");
  EXPECT_EQ(file_complaint("1 2 inf\n"), ":1: the weight of node 1 hearing node 2 must be finite");
  EXPECT_EQ(file_complaint("1 2 nan\n"), ":1: the weight of node 1 hearing node 2 must be finite");
  EXPECT_EQ(file_complaint("1 2 0\n"), ":1: the weight of node 1 hearing node 2 must not be 0");
  EXPECT_EQ(file_complaint("1 2 1\n3 3 1\n"), ":2: node 3 must not hear itself");
  EXPECT_EQ(file_complaint("0 2 1\n"), ":1: nodes are whole numbers from 1, not 0");
  EXPECT_EQ(file_complaint("1 2.5 1\n"), ":1: nodes are whole numbers from 1, not 2.5");
  EXPECT_EQ(file_complaint("# nothing\n"), " has no links");
}

// ---- Rules ----------------------------------------------------------------------------------------------------------

TEST(GraphRules, StrongConnection) {
  auto const fault = [](std::vector<double> const& triples, int nodes) {
    return test::complaint_of<ParameterError>([&] { require_strongly_connected(graph_of(triples, nodes)); });
  };
  EXPECT_EQ(fault(paper, 5), "");
  EXPECT_EQ(fault({1, 2, 1, 2, 3, 1, 3, 1, 1}, 3), "");
  EXPECT_EQ(fault({1, 2, 1, 2, 3, 1}, 3),
            "parameter graph: must be strongly connected: node 2 does not hear node 1, not even through others");
  EXPECT_EQ(fault({1, 2, 1, 2, 1, 1, 3, 1, 1}, 3),
            "parameter graph: must be strongly connected: node 1 does not hear node 3, not even through others");
  EXPECT_NE(strong_connection_fault(graph_of({1, 2, 1}, 2)), "");
  EXPECT_EQ(strong_connection_fault(graph_of({1, 2, 1, 2, 1, 1}, 2)), "");
}

TEST(GraphRules, ConnectionIgnoresDirections) {
  EXPECT_FALSE(node_apart(graph_of({1, 2, 1, 3, 2, 1}, 3)));
  EXPECT_EQ(node_apart(graph_of({1, 2, 1, 3, 4, 1}, 4)), 2);
  EXPECT_EQ(test::complaint_of<ParameterError>([] {
              require_connected(graph_of({1, 2, 1, 3, 4, 1}, 4));
            }),
            "parameter graph: must be connected: no links lead from node 3 to node 1");
}

TEST(GraphRules, WeightsAndBalance) {
  EXPECT_EQ(test::complaint_of<ParameterError>([] {
              require_positive_weights(graph_of({1, 2, 1, 2, 1, -1}, 2));
            }),
            "parameter graph: weights must be greater than 0: node 2 hears node 1 with -1");
  std::vector<int> const group{0, 0, 1, 1};
  auto const fault = [&](std::vector<double> const& triples) {
    return test::complaint_of<ParameterError>([&] { require_balance(graph_of(triples, 4), group); });
  };
  EXPECT_EQ(fault({1, 2, 7, 3, 4, -7}), "") << "links within a group are free";
  EXPECT_EQ(fault({1, 3, 0.5, 1, 4, -0.5}), "");
  EXPECT_EQ(fault({2, 3, 1, 2, 4, -0.5}),
            "parameter graph: must be in-degree balanced: what node 2 hears from group 2 must sum to 0, not 0.5");
  EXPECT_EQ(fault({4, 1, -1}),
            "parameter graph: must be in-degree balanced: what node 4 hears from group 1 must sum to 0, not -1");
}

// ---- The Laplacian --------------------------------------------------------------------------------------------------

TEST(Laplacian, OfThePapersGraphByHand) {
  Eigen::MatrixXd wanted(5, 5);
  wanted << 2, -1, 0, 0, -1, /**/ 0, 2, -1, -1, 0, /**/ 0, 0, 1, -1, 0, /**/ -1, 0, 0, 1, 0, /**/ 0, 0, 0, -1, 1;
  EXPECT_EQ(laplacian(graph_of(paper, 5)), wanted);
  std::vector<double> const p = left_null_vector(graph_of(paper, 5)), by_hand{0.2, 0.1, 0.1, 0.4, 0.2};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(p[i], by_hand[i], 1e-15) << i;
}

TEST(Laplacian, SpectraByHand) {
  // A complete graph of n: 0, and n, n - 1 times. A ring of n: 2 - 2 cos(2 pi k / n). A negative link: the other way.
  std::vector<double> const three{1, 2, 1, 1, 3, 1, 2, 3, 1}, four{1, 2, 1, 2, 3, 1, 3, 4, 1, 4, 1, 1}, apart{1, 2, -1};
  EXPECT_THAT(undirected_spectrum(undirected_graph_of(three, 3)), Pointwise(DoubleNear(1e-14), {0., 3., 3.}));
  EXPECT_THAT(undirected_spectrum(undirected_graph_of(four, 4)), Pointwise(DoubleNear(1e-14), {0., 2., 2., 4.}));
  EXPECT_THAT(undirected_spectrum(undirected_graph_of(apart, 2)), Pointwise(DoubleNear(1e-14), {-2., 0.}));
}

TEST(Laplacian, TheNullVectorOfARandomDigraphIsPositive) {
  Graph const graph = random_digraph(60, 7);
  std::vector<double> const p = left_null_vector(graph);
  Eigen::Map<Eigen::VectorXd const> const vector(p.data(), 60);
  EXPECT_LT((vector.transpose() * laplacian(graph)).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_GT(vector.minCoeff(), 0);
  EXPECT_NEAR(vector.sum(), 1, 1e-14);
}

// ---- Seeded digraphs ------------------------------------------------------------------------------------------------

TEST(RandomDigraph, IsItsSeed) {
  Graph const a = random_digraph(1000, 1), b = random_digraph(1000, 1), c = random_digraph(1000, 2);
  EXPECT_EQ(a.heard, b.heard);
  EXPECT_NE(a.heard, c.heard);
  // mt19937_64 of seed 5489 begins with 14514284786278117030 (its authors' reference output) = 2 mod 4.
  Graph const known = random_digraph(6, 5489);
  EXPECT_EQ(heard_by(known, 0), (Heard{{5, 1}, {0 + 1 + int(14514284786278117030u % 4), 1}}));
}

TEST(RandomDigraph, AlwaysHoldsTheRulesOfAGraph) {
  for (int nodes : {2, 3, 4, 5, 17, 300})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Graph const graph = random_digraph(nodes, seed);
      EXPECT_EQ(strong_connection_fault(graph), "") << nodes << " nodes, seed " << seed;
      std::vector<double> triples;
      for (int i = 0; i < nodes; ++i)
        graph.each_heard(i, [&](int j, double w) { triples.insert(triples.end(), {i + 1., j + 1., w}); });
      EXPECT_EQ(graph_complaint(triples, nodes), "") << nodes << " nodes, seed " << seed;
      EXPECT_EQ(graph.links(), nodes > 2 ? 2 * nodes : 2);
    }
}

TEST(RandomDigraph, IsLinearInItsNodes) {
  int const nodes = 100000;
  Graph const graph = random_digraph(nodes, 1);
  EXPECT_EQ(graph.first.size(), std::size_t(nodes) + 1);
  EXPECT_LE(graph.heard.capacity() + graph.weight.capacity(), 4 * std::size_t(nodes));
  EXPECT_EQ(strong_connection_fault(graph), "");
}

// ---- The laws, link by link -----------------------------------------------------------------------------------------

TEST(Protocols, ByHand) {
  Quat<double> const own{0.1, 0.2, 0.3, -0.9}, heard{0.4, 0.1, -0.5, 0.7};
  expect_near(protocol7(2.0, own, heard), {0.6, -0.2, -1.6}, 1e-15);
  expect_near(protocol13(2.0, own, heard, true), {0.6, -0.2, -1.6}, 1e-15);
  expect_near(protocol13(2.0, own, heard, false), {-1, -0.6, 0.4}, 1e-15);
}

TEST(Protocols, TurningAQuaternionsSignTurnsItsRateUnder13) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    Quat<double> const own = random.attitude(), heard = random.attitude(), other = scaled(-1.0, own);
    bool const same = random.uniform(0, 1) < 0.5;
    expect_near(protocol13(1.5, other, heard, !same), -1.0 * protocol13(1.5, own, heard, same), 0);
  }
}

TEST(Consensus, TorqueByHand) {
  // At sigma = 0, G = 1/4; at sigma = (1, 0, 0): 2 G = hat(sigma) + sigma sigma^T, G^T v = (v_x, v_z, -v_y) / 2.
  ConsensusSum<double> sum;
  sum.hear(2.0, {1, 2, -1}, {0, 0, 1});
  sum.hear(-1.0, {0, 4, 2}, {1, 0, 0});
  expect_near(sum.apart, {2, 0, -4}, 0);
  expect_near(sum.slip, {-1, 0, 2}, 0);
  expect_near(sum.torque({0, 0, 0}), {-0.5 + 1, 0, 1.0 - 2}, 1e-15);
  expect_near(sum.torque({1, 0, 0}), {-1 + 1, 2, -2}, 1e-15);
}

}  // namespace
}  // namespace polhode
