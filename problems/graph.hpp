#pragma once
/// Who hears whom in a swarm: weighted digraphs, the rules that a user's graph can break. (Spectra of small ones:
/// laplacian.hpp.)
/// Users write links as number triples (i, j, weight), nodes from 1: node i hears node j with weight a_ij.
/// Inside, nodes count from 0, and everything that a field looks at is linear in nodes and links.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>
#include <utility>

#include "problems/parameters.hpp"

namespace polhode {

/// Compressed rows: node i hears heard[k] with weight[k] for first[i] <= k < first[i + 1].
struct Graph {
  std::vector<std::int32_t> first{0}, heard;
  std::vector<double> weight;

  int nodes() const { return int(first.size()) - 1; }
  int links() const { return int(heard.size()); }
  /// f(j, a_ij) for every node j that node i hears.
  template <class F>
  void each_heard(int i, F&& f) const {
    for (auto k = std::size_t(first[std::size_t(i)]), end = std::size_t(first[std::size_t(i) + 1]); k < end; ++k)
      f(int(heard[k]), weight[k]);
  }
};

namespace graph_rules {

[[noreturn]] inline void refuse(std::string const& why) {
  throw ParameterError("parameter graph: " + why);
}
/// Node as users count.
inline std::string node(int i) {
  return "node " + std::to_string(i + 1);
}
/// A number as users write it.
inline std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// Why three numbers are no link; empty if they are one.
inline std::string fault(double i, double j, double weight) {
  for (double end : {i, j})
    if (!(end >= 1) || end != std::floor(end) || end > 1e9) return "nodes are whole numbers from 1, not " + text(end);
  if (i == j) return "node " + text(i) + " must not hear itself";
  if (!std::isfinite(weight)) return "the weight of node " + text(i) + " hearing node " + text(j) + " must be finite";
  if (weight == 0) return "the weight of node " + text(i) + " hearing node " + text(j) + " must not be 0";
  return "";
}

/// The first node that node 0 does not reach along the links of these graphs, all on the same nodes; nothing if it
/// reaches every one.
inline std::optional<int> out_of_reach(std::initializer_list<Graph const*> graphs) {
  std::vector<bool> seen(std::size_t((*graphs.begin())->nodes()), false);
  std::vector<int> open;
  auto const visit = [&](int i) {
    if (seen[std::size_t(i)]) return;
    seen[std::size_t(i)] = true;
    open.push_back(i);
  };
  if (!seen.empty()) visit(0);
  while (!open.empty()) {
    int const i = open.back();
    open.pop_back();
    for (Graph const* graph : graphs) graph->each_heard(i, [&](int j, double) { visit(j); });
  }
  auto const found = std::find(seen.begin(), seen.end(), false);
  if (found == seen.end()) return {};
  return int(found - seen.begin());
}

}  // namespace graph_rules

// ---- Making graphs --------------------------------------------------------------------------------------------------

/// The graph of the links for which each_link(link) calls link(i, j, a_ij), nodes from 0; it is called twice.
template <class EachLink>
Graph compressed(int nodes, EachLink const& each_link) {
  Graph graph;
  graph.first.assign(std::size_t(nodes) + 1, 0);
  each_link([&](int i, int, double) { ++graph.first[std::size_t(i) + 1]; });
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.heard.resize(std::size_t(graph.first.back()));
  graph.weight.resize(graph.heard.size());
  std::vector<std::int32_t> next = graph.first;
  each_link([&](int i, int j, double weight) {
    auto const at = std::size_t(next[std::size_t(i)]++);
    graph.heard[at] = std::int32_t(j);
    graph.weight[at] = weight;
  });
  return graph;
}
/// The graph of `nodes` nodes with these links. Throws ParameterError.
inline Graph graph_of(std::vector<double> const& triples, int nodes) {
  using namespace graph_rules;
  if (triples.size() % 3 != 0) refuse("takes 3 numbers a link (node, node that it hears, weight)");
  for (std::size_t k = 0; k < triples.size(); k += 3) {
    if (std::string const why = fault(triples[k], triples[k + 1], triples[k + 2]); !why.empty()) refuse(why);
    for (double end : {triples[k], triples[k + 1]})
      if (end > nodes) refuse("node " + text(end) + " does not exist: there are " + std::to_string(nodes));
  }
  Graph const graph = compressed(nodes, [&](auto const& link) {
    for (std::size_t k = 0; k < triples.size(); k += 3)
      link(int(triples[k]) - 1, int(triples[k + 1]) - 1, triples[k + 2]);
  });
  std::vector<int> hearer(std::size_t(nodes), -1);  // the last node found to hear this one
  for (int i = 0; i < nodes; ++i)
    graph.each_heard(i, [&](int j, double) {
      if (std::exchange(hearer[std::size_t(j)], i) == i) refuse(node(i) + " hears " + node(j) + " twice");
    });
  return graph;
}
/// The same with every link in both directions; each is written once.
inline Graph undirected_graph_of(std::vector<double> const& triples, int nodes) {
  std::vector<double> both = triples;
  for (std::size_t k = 0; k + 2 < triples.size(); k += 3)
    both.insert(both.end(), {triples[k + 1], triples[k], triples[k + 2]});
  return graph_of(both, nodes);
}

/// Triples from lines `i j weight`; # begins a comment. Throws ParameterError with `file`, as they are called, and
/// line.
inline std::vector<double> read_graph(std::istream& in, std::string const& file) {
  std::vector<double> triples;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    auto const refuse = [&](std::string const& why) {
      graph_rules::refuse(file + ":" + std::to_string(number) + ": " + why);
    };
    std::istringstream words(line.substr(0, line.find('#')));
    std::vector<double> numbers;
    for (std::string word; words >> word;) {
      double value = 0;
      auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error == std::errc::result_out_of_range) refuse("out of range: " + word);
      if (error != std::errc() || end != word.data() + word.size()) refuse("not a number: " + word);
      numbers.push_back(value);
    }
    if (numbers.empty()) continue;
    if (numbers.size() != 3) refuse("a link is `i j weight`, not " + std::to_string(numbers.size()) + " number(s)");
    if (std::string const why = graph_rules::fault(numbers[0], numbers[1], numbers[2]); !why.empty()) refuse(why);
    triples.insert(triples.end(), numbers.begin(), numbers.end());
  }
  if (in.bad()) graph_rules::refuse("cannot read " + file);
  if (triples.empty()) graph_rules::refuse(file + " has no links");
  return triples;
}

/// Every link turned around: whom i hears there hears i here.
inline Graph reversed(Graph const& graph) {
  return compressed(graph.nodes(), [&](auto const& link) {
    for (int i = 0; i < graph.nodes(); ++i) graph.each_heard(i, [&](int j, double weight) { link(j, i, weight); });
  });
}

/// A ring, in which each node hears the one before (so the graph is strongly connected), and for each node one more
/// that it hears, at random; weights 1. Equal on every machine, as the distributions of the standard library are
/// not. Two nodes: the ring alone.
inline Graph random_digraph(int nodes, std::uint64_t seed) {
  std::mt19937_64 bits(seed);
  Graph graph;
  graph.first.reserve(std::size_t(nodes) + 1);
  graph.heard.reserve(2 * std::size_t(nodes));
  for (int i = 0; i < nodes; ++i) {
    graph.heard.push_back((i + nodes - 1) % nodes);
    if (nodes > 2)
      graph.heard.push_back(int((std::uint64_t(i) + 1 + bits() % std::uint64_t(nodes - 2)) % std::uint64_t(nodes)));
    graph.first.push_back(std::int32_t(graph.heard.size()));
  }
  graph.weight.assign(graph.heard.size(), 1);
  return graph;
}

// ---- Rules ----------------------------------------------------------------------------------------------------------

inline void require_positive_weights(Graph const& graph) {
  using namespace graph_rules;
  for (int i = 0; i < graph.nodes(); ++i)
    graph.each_heard(i, [&](int j, double weight) {
      if (!(weight > 0))
        refuse("weights must be greater than 0: " + node(i) + " hears " + node(j) + " with " + text(weight));
    });
}

/// Node 0 hears everyone and everyone hears node 0, through others if need be. If not: who fails, in words.
inline std::string strong_connection_fault(Graph const& graph) {
  using namespace graph_rules;
  Graph const hearers = reversed(graph);
  if (auto const i = out_of_reach({&graph}))
    return node(0) + " does not hear " + node(*i) + ", not even through others";
  if (auto const i = out_of_reach({&hearers}))
    return node(*i) + " does not hear " + node(0) + ", not even through others";
  return "";
}
inline void require_strongly_connected(Graph const& graph) {
  std::string const why = strong_connection_fault(graph);
  if (!why.empty()) graph_rules::refuse("must be strongly connected: " + why);
}

/// A node without a path to node 0, whichever way links point; nothing if there is none.
inline std::optional<int> node_apart(Graph const& graph) {
  Graph const hearers = reversed(graph);
  return graph_rules::out_of_reach({&graph, &hearers});
}
inline void require_connected(Graph const& graph) {
  using namespace graph_rules;
  if (auto const i = node_apart(graph)) refuse("must be connected: no links lead from " + node(*i) + " to " + node(0));
}

/// In-degree balance: what each node hears from each group but its own sums to 0. group[i] is the group of node i, from
/// 0.
inline void require_balance(Graph const& graph, std::vector<int> const& group) {
  using namespace graph_rules;
  int const groups = *std::max_element(group.begin(), group.end()) + 1;
  for (int i = 0; i < graph.nodes(); ++i) {
    std::vector<double> sum(std::size_t(groups), 0), size(std::size_t(groups), 0);
    graph.each_heard(i, [&](int j, double weight) {
      sum[std::size_t(group[std::size_t(j)])] += weight;
      size[std::size_t(group[std::size_t(j)])] += std::fabs(weight);
    });
    for (int g = 0; g < groups; ++g)
      if (g != group[std::size_t(i)] && std::fabs(sum[std::size_t(g)]) > 1e-12 * size[std::size_t(g)])
        refuse("must be in-degree balanced: what " + node(i) + " hears from group " + std::to_string(g + 1) +
               " must sum to 0, not " + text(sum[std::size_t(g)]));
  }
}

}  // namespace polhode
