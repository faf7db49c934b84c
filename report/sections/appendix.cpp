#include <fmt/format.h>

#include <map>
#include <set>
#include <tuple>

#include "report/sections/sections.hpp"
#include "report/text.hpp"
#include "results/meta.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// What the files say of a name, each text once: "AMD EPYC" or "A and B"; empty if none says anything.
std::string meta_of(Facts const& facts, std::string const& name) {
  auto const texts = results::entries_of(facts.contents.metas, name);
  return listed({texts.begin(), texts.end()});
}

/// Status, reason, name of the problem; its label and the method, which refusals for one reason share a row without.
using FailureKey = std::tuple<std::string, std::string, std::string, std::string, std::string>;

struct Failures {
  std::set<std::string> problems, methods;
  std::vector<std::string> controls;  ///< of every run
};

/// Runs that ended well, with something to be known about them: warnings, missing references.
void add_remarks(Document& document, Facts const& facts) {
  std::map<std::pair<std::string, std::string>, std::size_t> remarks;
  for (Instance const& instance : facts.instances)
    for (Record const* run : instance.runs)
      if (is_ok(*run) && !run->reason.empty()) ++remarks[{instance.label, run->reason}];
  if (remarks.empty()) return;
  Table table{.name = "remarks",
              .caption = "Runs that ended well, and what should be known about them.",
              .columns = {{"problem"}, {"remark"}, {"runs", true}}};
  for (auto const& [key, n] : remarks) table.rows.push_back({key.first, key.second, std::to_string(n)});
  document.add(std::move(table));
}

}  // namespace

std::string timing_note(Facts const& facts) {
  std::set<int> repetitions;
  for (Record const* run : facts.runs) {
    if (run->cpu_time_s) repetitions.insert(run->cpu_time_s->repetitions);
  }
  if (repetitions.empty()) return "Nothing was timed.";
  std::string machine = meta_of(facts, "cpu_model");
  if (machine.empty()) machine = "a machine that the records do not name";
  if (auto const cpus = meta_of(facts, "cpus_available"); !cpus.empty()) machine += fmt::format(", CPUs: {}", cpus);
  if (meta_of(facts, "virtualised") == "true") machine += ", virtualised";
  if (auto const load = meta_of(facts, "load"); !load.empty()) {
    machine += fmt::format(", load {}", load.substr(0, load.find(' ')));
  }
  if (auto const compiler = meta_of(facts, "compiler"); !compiler.empty()) machine += fmt::format("; {}", compiler);
  if (auto const flags = meta_of(facts, "flags"); !flags.empty()) machine += fmt::format(" {}", flags);
  int const low = *repetitions.begin(), high = *repetitions.rbegin();
  return fmt::format("CPU times: medians of {} interleaved repetitions, their 95% intervals in the CSV file; on {}.",
                     low == high ? std::to_string(low) : fmt::format("{} to {}", low, high), machine);
}

void add_failures(Document& document, Facts const& facts) {
  document.section("Failures and refusals");
  std::map<FailureKey, Failures> groups;
  std::size_t n = 0;
  for (Instance const& instance : facts.instances) {
    for (Record const* run : instance.runs) {
      if (is_ok(*run)) continue;
      ++n;
      bool const refused = run->status == results::Status::refused;
      std::string const reason = run->reason.empty() ? "no reason recorded" : run->reason;
      Failures& group = groups[{std::string(name_of(run->status)), reason, run->of.problem,
                                refused ? "" : instance.label, refused ? "" : method_of(run->of)}];
      group.problems.insert(instance.label);
      group.methods.insert(method_of(run->of));
      group.controls.push_back(control_of(run->of));
    }
  }
  Table table{
      .name = "failures",
      .caption = fmt::format("{} that did not end well, by status and reason. A failure counts as infinite in every "
                             "ranking above. Refusals of a problem for one reason share a row.",
                             counted(n, "run", "runs")),
      .columns = {{"status"}, {"reason"}, {"problem"}, {"method"}, {"runs", true}, {"control"}}};
  for (auto const& [key, group] : groups) {
    auto const& [status, reason, name, label, method] = key;
    bool const alike = group.problems.size() == 1 && group.methods.size() == 1;
    table.rows.push_back({status, reason,
                          group.problems.size() == 1 ? *group.problems.begin()
                                                     : fmt::format("{}, {} variants", name, group.problems.size()),
                          shortened({group.methods.begin(), group.methods.end()}, 9),
                          std::to_string(group.controls.size()),
                          alike ? fmt::format("{}", fmt::join(group.controls, "; ")) : std::string(absent)});
  }
  if (n > 0) {
    document.add(std::move(table));
  } else {
    document.say(facts.runs.empty() ? "There are no runs, hence no failures." : "Every run ended with status ok.");
  }
  add_remarks(document, facts);
  auto const& unfinished = facts.contents.unfinished;
  if (!unfinished.empty()) {
    document.say(fmt::format("{} begun and never finished, which means that the process died or is still at work: {}.",
                             unfinished.size() == 1 ? "1 cell was" : std::to_string(unfinished.size()) + " cells were",
                             listed(unfinished)));
  }
}

void add_references(Document& document, Facts const& facts) {
  document.section("References and provenance");
  std::map<std::pair<std::string, std::optional<double>>, std::pair<std::set<std::string>, std::size_t>> uses;
  std::size_t without = 0;
  for (Instance const& instance : facts.instances) {
    for (Record const* run : instance.runs) {
      if (run->reference.empty()) {
        ++without;
        continue;
      }
      auto& [problems, count] = uses[{run->reference, finite(run->reference_bar)}];
      problems.insert(instance.label);
      ++count;
    }
  }
  Table table{.name = "references",
              .caption =
                  "What attitude errors were measured against. The bar bounds the reference's own error; a smaller "
                  "measured error says no more than that.",
              .columns = {{"reference"}, {"problem"}, {"bar [rad]", true}, {"[arcsec]", true}, {"runs", true}}};
  for (auto const& [key, use] : uses) {
    auto const& [name, bar] = key;
    std::vector<std::string> const problems(use.first.begin(), use.first.end());
    table.rows.push_back({name, fmt::format("{}", fmt::join(problems, "; ")), number(bar),
                          bar ? number(arcseconds(*bar)) : Entry(absent), std::to_string(use.second)});
  }
  if (table.rows.empty()) {
    document.say("No run here has a reference, so no error is certified.");
  } else {
    document.add(std::move(table));
    if (without > 0)
      document.say(
          fmt::format("{} no reference.", without == 1 ? "1 run has" : std::to_string(without) + " runs have"));
  }
}

void add_provenance(Document& document, Facts const& facts) {
  document.heading(3, "Provenance");
  std::map<std::string, std::size_t> builds;
  for (Record const* run : facts.runs) ++builds[run->build];
  std::vector<std::string> words;
  for (auto const& [build, n] : builds)
    words.push_back(fmt::format("{} ({})", build.empty() ? "unnamed" : build, counted(n, "run", "runs")));
  auto const files = facts.contents.metas.size();
  document.say(fmt::format(
      "{} in {}{}.", counted(facts.runs.size(), "run", "runs"), counted(files, "file", "files"),
      words.empty() ? "" : ", made by " + std::string(words.size() == 1 ? "build " : "builds ") + listed(words)));
  if (facts.superseded > 0) {
    document.say(
        fmt::format("{} replaced by a later run of the same cell.",
                    facts.superseded == 1 ? "1 record was" : std::to_string(facts.superseded) + " records were"));
  }
  std::map<std::pair<std::string, std::string>, std::size_t> values;
  for (results::Meta const& meta : facts.contents.metas) {
    for (auto const& [key, value] : meta) ++values[{key, value}];
  }
  Table table{.name = "provenance",
              .caption = "Where and how the records were made.",
              .columns = {{"what"}, {"value"}, {"files", true}}};
  for (auto const& [item, n] : values) table.rows.push_back({item.first, item.second, std::to_string(n)});
  if (table.rows.empty()) {
    document.say("The records say nothing about where and how they were made.");
  } else {
    document.add(std::move(table));
  }
}

}  // namespace polhode::report
