#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "report/sections/speed.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Benchmark;
using results::Benchmarks;

std::optional<double> counter_of(Benchmark const& benchmark, std::string const& name) {
  auto const found = benchmark.counters.find(name);
  return found == benchmark.counters.end() ? std::nullopt : finite(found->second);
}
/// The time [s] of a step if it counts steps, else of an iteration. The interval is that of the iteration's time.
Estimate time_of(Benchmark const& benchmark) {
  auto const& t = benchmark.time;
  double const part = counter_of(benchmark, "per_step").value_or(t.median) / t.median;
  return {part * t.median, part * t.low, part * t.high};
}
std::optional<Estimate> time_of(Benchmarks const& all, std::string_view name) {
  Benchmark const* found = all.find(name);
  return found ? std::optional(time_of(*found)) : std::nullopt;
}
Entry seconds(std::optional<Estimate> const& price) {
  return price ? cpu_time(*price) : Entry(absent);
}
Entry times(std::optional<Estimate> const& ratio) {
  return ratio ? number(*ratio) : Entry(absent);
}

std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= name.size();) {
    std::size_t const to = std::min(name.find('/', from), name.size());
    parts.emplace_back(name.substr(from, to - from));
    from = to + 1;
  }
  return parts;
}

// ---- Steps ----------------------------------------------------------------------------------------------------------

void add_steps(Document& document, Benchmarks const& all) {
  constexpr std::string_view problems[] = {"free_body", "pd_slew", "tether_capture"};
  using Key = std::tuple<bool, std::string, std::string>;  // a rival, integrator, formulation
  std::map<Key, std::map<std::string, Estimate>> rows;
  for (Benchmark const& benchmark : all.all) {
    auto const parts = parts_of(benchmark.name);
    if (parts.size() != 4 || parts[0] != "step" || std::ranges::find(problems, parts[1]) == std::end(problems))
      continue;
    rows[{is_rival(parts[3]), parts[3], parts[2]}][parts[1]] = time_of(benchmark);
  }
  if (rows.empty()) return;
  Table table{.name = "speed-steps",
              .caption =
                  "A step of fixed length, within a solve. Of tether_capture with the controller asked at every "
                  "second step. Steps of other problems stand in benchmarks.json.",
              .columns = {{"method"}, {"formulation"}, {"side"}}};
  for (std::string_view const problem : problems) table.columns.push_back({std::string(problem), true});
  for (auto const& [key, prices] : rows) {
    auto const& [rival, integrator, formulation] = key;
    std::vector<Entry> row{integrator, formulation, rival ? std::string(library_of(integrator)) : std::string("own")};
    for (std::string_view const problem : problems) {
      auto const found = prices.find(std::string(problem));
      row.push_back(found == prices.end() ? Entry(absent) : seconds(found->second));
    }
    table.rows.push_back(std::move(row));
  }
  document.heading(3, "Steps");
  document.add(std::move(table));
}

// ---- Many bodies ----------------------------------------------------------------------------------------------------

/// The faster of the two loops over Odeint on that problem.
std::optional<Estimate> odeint_loop(Benchmarks const& all, std::string const& problem) {
  auto const plain = time_of(all, fmt::format("ensemble/{}/odeint_rk4", problem));
  auto const wide = time_of(all, fmt::format("ensemble/{}/odeint_rk4_avx2", problem));
  return plain && wide ? (wide->value < plain->value ? wide : plain) : (plain ? plain : wide);
}

void add_ensembles(Document& document, Benchmarks const& all) {
  Table table{.name = "speed-ensembles",
              .caption =
                  "Ensembles of 4096 bodies, on one core where nothing else is said (threads by wall time): a "
                  "step of one body. Odeint: its loop over the same bodies, the faster of two builds, over that "
                  "time. Of the bound: what the fused operations alone would take at the peak of this core, "
                  "measured in the same run, one for each multiplication of the step. Lost: the greatest "
                  "difference from double.",
              .columns = {{"problem"},
                          {"ensemble"},
                          {"per body and step", true},
                          {"Odeint", true},
                          {"of the bound [%]", true},
                          {"lost", true}}};
  auto const peak = time_of(all, "ensemble/fused_peak");
  for (Benchmark const& benchmark : all.all) {
    auto const parts = parts_of(benchmark.name);
    if (parts.size() != 3 || parts[0] != "ensemble" || parts[2].starts_with("odeint")) continue;
    Estimate const price = time_of(benchmark);
    bool const rk4 = parts[2] == "rk4";
    auto const rival = parts[2].starts_with("rk4") && !benchmark.wall ? odeint_loop(all, parts[1]) : std::nullopt;
    // the bound counts the operations of this problem in double
    Entry bound = absent;
    if (peak && rk4 && parts[1] == "free_body") bound = number(100 * quotient(*peak, price).value);
    table.rows.push_back({parts[1], parts[2], seconds(price),
                          times(rival ? std::optional(quotient(*rival, price)) : std::nullopt), std::move(bound),
                          number(counter_of(benchmark, "lost"))});
  }
  if (table.rows.empty()) return;
  document.heading(3, "Ensembles");
  document.add(std::move(table));
}

void add_networks(Document& document, Benchmarks const& all) {
  std::map<std::string, std::map<int, Estimate>> rows;
  std::map<int, bool> sizes;
  for (Benchmark const& benchmark : all.all) {
    auto const parts = parts_of(benchmark.name);
    if (parts.size() != 5 || parts[0] != "network" || parts[4].empty() || parts[4].size() > 8 ||
        parts[4].find_first_not_of("0123456789") != std::string::npos)
      continue;
    int const n = std::stoi(parts[4]);
    rows[fmt::format("{} ({})", parts[3], parts[2])][n] = time_of(benchmark);
    sizes[n] = true;
  }
  if (rows.empty()) return;
  Table table{
      .name = "speed-networks",
      .caption =
          "Networks of quaternion_sync over the same second: a step of one craft. Each hears its neighbour and one at "
          "random, wherever in memory that is. The last column is the largest network over that of 100.",
      .columns = {{"method"}}};
  for (auto const& [n, there] : sizes) table.columns.push_back({fmt::format("n = {}", n), true});
  table.columns.insert(table.columns.end(), {{"largest / 100", true}, {"95%"}});
  for (auto const& [method, prices] : rows) {
    std::vector<Entry> row{method};
    for (auto const& [n, there] : sizes) row.push_back(prices.contains(n) ? seconds(prices.at(n)) : Entry(absent));
    auto const small = prices.find(100);
    bool const both = small != prices.end() && prices.rbegin()->first > 100;
    auto const ratio = both ? std::optional(quotient(prices.rbegin()->second, small->second)) : std::nullopt;
    row.push_back(times(ratio));
    row.emplace_back(ratio ? interval_of(*ratio) : absent);
    table.rows.push_back(std::move(row));
  }
  document.heading(3, "Networks");
  document.add(std::move(table));
}

// ---- Single figures -------------------------------------------------------------------------------------------------

struct Pair {
  std::string_view what, over, under;
};
constexpr Pair pairs[] = {
    {"RK4, free body: generic source / written by hand", "twin/free_body/rk4/generic", "twin/free_body/rk4/by_hand"},
    {"RK4, free body: Odeint on a plain array / ours", "plain/free_body/odeint_rk4", "step/free_body/quaternion/rk4"},
    {"RK4, free body: type forgotten at every evaluation / once per solve",
     "erased/free_body/quaternion/rk4/evaluation", "step/free_body/quaternion/rk4"},
    {"RK4, free body: type forgotten once per solve / never", "step/free_body/quaternion/rk4",
     "twin/free_body/rk4/generic"},
    {"ensemble of free bodies: double / single precision", "ensemble/free_body/rk4", "ensemble/free_body/rk4_float"},
    {"ensemble of limited slews: double / single precision", "ensemble/limited_slew/rk4",
     "ensemble/limited_slew/rk4_float"},
    {"ensemble, wall time: 1 thread / 2, runs of 200 steps", "ensemble/free_body/rk4_threads_1",
     "ensemble/free_body/rk4_threads_2"},
    {"ensemble, wall time: 1 thread / 2, runs of 4000 steps", "ensemble/free_body/rk4_long_threads_1",
     "ensemble/free_body/rk4_long_threads_2"}};

void add_ratios(Document& document, Benchmarks const& all) {
  Table table{.name = "speed-ratios",
              .caption =
                  "Pairs of one run: the time of the first over that of the second, with its 95% interval. What "
                  "two threads gain is told by the long runs; short ones also pay for starting the second thread.",
              .columns = {{"first / second"}, {"ratio", true}, {"95%"}}};
  for (Pair const& pair : pairs) {
    auto const over = time_of(all, pair.over), under = time_of(all, pair.under);
    if (!over || !under) continue;
    Estimate const ratio = quotient(*over, *under);
    table.rows.push_back({std::string(pair.what), times(ratio), interval_of(ratio)});
  }
  if (!table.rows.empty()) document.add(std::move(table));
}

void add_figures(Document& document, Benchmarks const& all) {
  Table table{.name = "speed-figures",
              .caption =
                  "Single figures. The periods of the sampled loop (its torque saturates; RK4, 5 steps) were "
                  "timed one by one, the clock included.",
              .columns = {{"what"}, {"value", true}}};
  auto const push = [&](std::string const& what, std::optional<Estimate> const& price) {
    if (price) table.rows.push_back({what, seconds(price)});
  };
  if (Benchmark const* worst = all.find("worst/limited_slew_sampled/rk4/period")) {
    for (auto const& [name, what] :
         {std::pair{"p50", "median"}, {"p99.9", "99.9% take at most"}, {"max", "the longest"}})
      if (auto const value = counter_of(*worst, name))
        table.rows.push_back({fmt::format("a period of sampled control: {}", what), {duration(*value), exact(*value)}});
  }
  push("closed form of the free body: a value", time_of(all, "exact/free_body/evaluation"));
  push("closed form of the free body: before the first", time_of(all, "exact/free_body/setup"));
  if (Benchmark const* certify = all.find("certify/free_body")) {
    auto const bar = counter_of(*certify, "bar");
    push(bar ? fmt::format("a certified reference of the free body, 50 s, to {} rad", significant(*bar, 2))
             : std::string("a certified reference of the free body, 50 s"),
         time_of(*certify));
  }
  push("starting a second thread and waiting for it, wall time", time_of(all, "ensemble/second_thread"));
  if (Benchmark const* peak = all.find("ensemble/fused_peak"))
    if (auto const flops = counter_of(*peak, "flops"))
      table.rows.push_back({"peak of fused operations on one core [GFLOP/s]", number(*flops / 1e9)});
  if (!table.rows.empty()) document.add(std::move(table));
}

}  // namespace

void add_benchmarks(Document& document, Facts const& facts) {
  Benchmarks const& all = facts.contents.benchmarks;
  if (all.all.empty()) {
    document.say(Text({{"The folder holds no figures of steps, ensembles and networks; "},
                       {"polhode-bench --out DIR", true},
                       {" adds them."}}));
    return;
  }
  int const repetitions = all.all.front().time.repetitions;
  add_steps(document, all);
  add_ensembles(document, all);
  add_networks(document, all);
  document.heading(3, "Figures beside them");
  document.say(
      fmt::format("Measured by polhode-bench: medians of {} interleaved repetitions; CPU times, where nothing "
                  "else is said.",
                  repetitions));
  add_ratios(document, all);
  add_figures(document, all);
}

}  // namespace polhode::report
