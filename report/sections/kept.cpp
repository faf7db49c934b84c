#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

bool is_shown(Record const& run) {
  return is_ok(run) && run.of.h && run.of.policy == "none" && finite(run.momentum_direction_max);
}

std::optional<double> shown_step(Instance const& instance) {
  std::map<double, std::set<std::string>> methods;
  for (Record const* run : instance.runs) {
    if (is_shown(*run)) methods[*run->of.h].insert(method_of(run->of));
  }
  return common_step(methods);
}

std::vector<std::string> kept_by(Record const& run) {
  std::vector<std::string> names;
  for (Invariant const& q : invariants) {
    if (finite(run.*q.drift).value_or(INFINITY) <= kept) names.emplace_back(q.name);
  }
  return names;
}

/// Methods that keep all numbers and yet turn the body's angular momentum in space.
std::string sentence(std::vector<Record const*> const& shown) {
  std::vector<std::string> names;
  double low = INFINITY, high = 0;
  for (Record const* run : shown) {
    if (kept_by(*run) != std::vector<std::string>{"norm", "energy", "|L|"}) continue;
    names.push_back(method_of(run->of));
    low = std::min(low, *run->momentum_direction_max);
    high = std::max(high, *run->momentum_direction_max);
  }
  if (names.empty()) return "No method here keeps norm, energy and |L| without keeping the direction of L.";
  bool const one = names.size() == 1;
  return fmt::format(
      "{} {} norm, energy and |L| to round-off, but not the direction of L in space, which {} by {} rad: "
      "the invariants alone do not show an attitude error.",
      listed(names), one ? "keeps" : "keep", one ? "moves" : "they move",
      one ? significant(high) : fmt::format("{} to {}", significant(low), significant(high)));
}

}  // namespace

void add_kept(Document& document, Facts const& facts) {
  document.section("What is kept");
  document.say(
      "Without torque a body keeps its energy and its angular momentum in space, L: its length |L| and its direction. "
      "A method in quaternions should keep their norm besides.");
  std::size_t n = 0;
  for (Instance const& instance : facts.instances) {
    auto const h = shown_step(instance);
    if (!h || is_aside(instance.like()) || has_word(instance.like().variant, "raw_q0")) continue;
    Table table{.name = fmt::format("kept-{}", ++n),
                .caption = fmt::format("{}: largest drift at h = {} s without projection. Energy and |L| are relative; "
                                       "\"kept\" means within 1e-13. Adaptive runs have no h and are not here.",
                                       instance.label, significant(*h)),
                .columns = {{"integrator"}, {"coordinates"}}};
    for (Invariant const& q : invariants) table.columns.push_back({fmt::format("{}{}", q.name, q.unit), true});
    table.columns.push_back({"attitude error [rad]", true});
    table.columns.push_back({"kept"});
    std::vector<Record const*> shown;
    for (Sweep const& sweep : instance.sweeps()) {
      for (Record const* run : sweep.runs) {
        if (is_shown(*run) && run->of.h == h) shown.push_back(run);
      }
    }
    for (Record const* run : shown) {
      std::vector<Entry> row{run->of.integrator, run->of.formulation};
      for (Invariant const& q : invariants) row.push_back(number(run->*q.drift, 2));
      row.push_back(number(run->attitude_error_max, 2));
      auto const names = kept_by(*run);
      row.emplace_back(names.empty()                           ? std::string("nothing")
                       : names.size() == std::size(invariants) ? std::string("all four")
                                                               : fmt::format("{}", fmt::join(names, ", ")));
      table.rows.push_back(std::move(row));
    }
    document.add(std::move(table));
    document.say(sentence(shown));
  }
  if (n == 0) document.say("No run with fixed steps of a torque-free motion recorded its drift of energy and L.");
}

}  // namespace polhode::report
