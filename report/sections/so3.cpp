#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

constexpr std::array dashes{Dash::solid, Dash::dashed, Dash::dotted, Dash::dash_dot, Dash::solid};

/// The law's choices besides the method.
constexpr double own_delta = 0.1, own_rho = 0.8;  // the problem's
double delta_of(Cell const& c) {
  return parameter(c, "delta", own_delta);
}
double rho_of(Cell const& c) {
  return parameter(c, "rho", own_rho);
}
std::string gains_of(Cell const& c) {
  return has_word(c.variant, "set_p") ? "set_p" : "set_e";
}
std::string surface_of(Cell const& c) {
  for (char const* word : {"near", "switching"}) {
    if (has_word(c.variant, word)) return word;
  }
  return "far";
}

Cell const& like(CaseRuns const& cases) {
  return cases.of.begin()->second->of;
}

/// The runs from small angles that tell t1, by gain set and parameters.
std::vector<CaseRuns> timed_runs(Facts const& facts) {
  auto list = case_runs(facts, so3_cooperative());
  for (CaseRuns& cases : list) {
    std::erase_if(cases.of, [](auto const& item) { return !item.second->claims.contains("t1"); });
  }
  std::erase_if(list, [](CaseRuns const& cases) { return cases.of.empty() || !has_word(like(cases).variant, "ex1"); });
  for (CaseRuns& cases : list) {
    Cell const& c = like(cases);
    cases.title = fmt::format("{}, delta = {}", gains_of(c), significant(delta_of(c)));
    if (rho_of(c) != own_rho) cases.title += fmt::format(", rho = {}", significant(rho_of(c)));
  }
  return list;
}

/// Those of them with two methods or more: what can be compared.
std::vector<CaseRuns> contests(std::vector<CaseRuns> list) {
  std::erase_if(list, [](CaseRuns const& cases) { return cases.of.size() < 2; });
  return list;
}

/// Times nearer to each other than this part are no order.
constexpr double equal_times = 0.005;

/// What one gain set makes of the methods.
struct Ranking {
  std::string gains, words = {};
  bool equal = false, as_printed = false;
};

std::optional<Ranking> rank(CaseRuns const& cases) {
  struct Time {
    std::string_view method;
    double ours, printed;
  };
  std::vector<Time> times;
  for (auto const method : so3_cooperative().cases) {
    Record const* run = cases.find(method);
    auto const ours = run ? claimed(*run, "t1") : std::nullopt;
    auto const printed = run ? finite(run->claims.at("t1").published) : std::nullopt;
    if (ours && printed) times.push_back({method.substr(6), *ours, *printed});
  }
  if (times.size() < 2) return {};
  std::ranges::stable_sort(times, {}, &Time::ours);
  Cell const& c = like(cases);
  Ranking r{.gains = fmt::format("{} (delta = {})", gains_of(c), significant(delta_of(c)))};
  double const spread = times.back().ours / times.front().ours - 1;
  r.equal = spread <= equal_times;
  r.as_printed = !r.equal && std::ranges::is_sorted(times, {}, &Time::printed);
  for (Time const& t : times) r.words += (r.words.empty() ? "" : " < ") + std::string(t.method);
  if (r.equal) r.words = fmt::format("they lie within {}% of each other", significant(100 * spread, 2));
  return r;
}

/// Whether the order of the methods is theirs, or their gains'.
void say_order(Document& document, std::vector<CaseRuns> const& sets) {
  std::vector<std::string> words;
  std::size_t as_printed = 0;
  for (CaseRuns const& cases : sets) {
    auto const ranking = rank(cases);
    if (!ranking) continue;
    as_printed += ranking->as_printed ? 1 : 0;
    words.push_back(fmt::format("with {} {}{}", ranking->gains, ranking->words,
                                ranking->equal        ? ""
                                : ranking->as_printed ? ", as printed"
                                                      : ", not as printed"));
  }
  if (words.empty()) return;
  std::string const head = as_printed == 0              ? "No gains here give the printed order of the times t1"
                           : as_printed == words.size() ? "All gains here give the printed order of the times t1"
                                                        : "The order of the methods by t1 is a matter of gains";
  document.say(fmt::format("{}: {}.", head, fmt::join(words, "; ")));
}

void add_times(Document& document, std::vector<CaseRuns> const& sets) {
  document.heading(3, "Claims and verdicts");
  if (sets.empty()) {
    document.say("No two methods were run with one set of gains, so their times are not compared.");
    return;
  }
  say_order(document, sets);
  document.add(claim_table(
      so3_cooperative(), sets, "so3_cooperative-claims",
      "The time t1 from which q_a stays below 1 deg: printed, and ours with either set of gains; \"yes\" within 5% of "
      "print, or .002 s of our own. The initial data behind the printed times are lost: their order can be judged, "
      "their values hardly."));
}

/// What rho, delta and the surfaces do to t1 under method 1.
void add_command(Document& document, std::vector<CaseRuns> const& sets) {
  Table table{
      .name = "so3-command",
      .caption =
          "Method 1 from small angles: t1 by surface, smoothing delta and feed-forward rho; \"yes\" if within "
          ".002 s of our own to many digits.",
      .columns = {{"surface"}, {"delta", true}, {"rho", true}, {"run"}, {"t1 [s]", true}, {"q_a at 5 s", true}}};
  std::optional<double> fed, not_fed;
  std::set<std::tuple<std::string, double, double>> seen;  // a parameter that is set may be the problem's own
  for (CaseRuns const& cases : sets) {
    Cell const& c = like(cases);
    Record const* run = cases.find("method1");
    if (!run || gains_of(c) != "set_e" || !seen.emplace(surface_of(c), delta_of(c), rho_of(c)).second) continue;
    bool const ours = run->claims.contains("t1_ours");
    table.rows.push_back({surface_of(c), number(delta_of(c)), number(rho_of(c)),
                          fmt::format("{}, {}", method_of(run->of), control_of(run->of)),
                          ours ? verdict_of(run, "t1_ours") : number(claimed(*run, "t1"), 4),
                          verdict_of(run, "q_a_5s")});
    if (surface_of(c) != "far" || delta_of(c) != own_delta) continue;
    if (rho_of(c) == own_rho) fed = claimed(*run, "t1");
    if (rho_of(c) == 0) not_fed = claimed(*run, "t1");
  }
  if (table.rows.size() < 2) return;
  document.add(std::move(table));
  if (!fed || !not_fed) return;
  document.say(fmt::format(
      "With .8 of the command's rate fed forward the craft are together at {} s, without it at {} s: so much lies in "
      "rho, which nothing printed decides.",
      significant(*fed, 4), significant(*not_fed, 4)));
}

void add_histories(Document& document, Facts const& facts, std::vector<CaseRuns> const& sets) {
  constexpr std::array colours{3, 12, 2};
  Figure figure{.name = "so3-methods",
                .caption =
                    "How far the craft are apart: root mean squares of the differences of Euler angles from craft 1's "
                    "(q_a, the paper's measure) and of the angle to it (q_geo). Stars: the printed times t1.",
                .columns = 2};
  for (CaseRuns const& cases : sets) {
    for (char const* column : {"q_a", "q_geo"}) {
      Panel panel{.x = {"t [s]"}, .y = {fmt::format("{} [deg]", column), true, 1e-4}, .title = cases.title};
      Curve printed{"printed t1", {.index = 8, .line = false}};
      for (std::size_t k = 0; k < colours.size(); ++k) {
        Record const* run = cases.find(so3_cooperative().cases[k]);
        if (!run) continue;
        Curve curve = against_time(facts, *run, column, fmt::format("method {}", k + 1),
                                   {.index = colours[k], .dash = dashes[k], .points = false});
        auto const t1 = finite(run->claims.at("t1").published);
        if (t1 && !curve.points.empty() && column == std::string_view("q_a")) printed.points.push_back({*t1, 1});
        add_curve(panel, std::move(curve));
      }
      add_curve(panel, std::move(printed));
      figure.panels.push_back(std::move(panel));
    }
  }
  add_figure(document, std::move(figure));
}

/// The finest history of a run of method 1 on the far surface, of that example, between two times.
Record const* finest(Facts const& facts, std::string_view example, double from, double to) {
  Record const* best = nullptr;
  std::ptrdiff_t most = 0;
  for (Record const* run : facts.runs) {
    Cell const& c = run->of;
    if (c.problem != so3_cooperative().problem || !is_ok(*run)) continue;
    if (!has_word(c.variant, example) || !has_word(c.variant, "method1") || surface_of(c) != "far") continue;
    results::Series const* series = facts.series_of(*run, "history");
    if (!series) continue;
    auto const rows = std::ranges::count_if(
        series->rows, [&](auto const& row) { return !row.empty() && from <= row[0] && row[0] <= to; });
    if (rows <= most) continue;
    most = rows;
    best = run;
  }
  return best;
}

void add_torques(Document& document, Facts const& facts) {
  constexpr std::array colours{3, 12, 2, 4, 6};
  Record const* run = finest(facts, "ex1", 0, 20);
  if (!run) return;
  Figure figure{
      .name = "so3-torques",
      .caption = fmt::format("Torques under method 1, delta = {}, rho = {}: {}, {}.", significant(delta_of(run->of)),
                             significant(rho_of(run->of)), method_of(run->of), control_of(run->of)),
      .columns = 2};
  double greatest = 0;
  for (char const axis : {'x', 'y', 'z'}) {
    Panel panel{.x = {"t [s]"}, .y = {fmt::format("M_{} [N m]", axis)}};
    for (std::size_t k = 0; k < colours.size(); ++k) {
      add_curve(panel, against_time(facts, *run, fmt::format("b{}.m{}", k + 1, axis), fmt::format("craft {}", k + 1),
                                    {.index = colours[k], .dash = dashes[k], .points = false}));
      if (panel.curves.empty()) continue;
      for (Point const& p : panel.curves.back().points) greatest = std::max(greatest, std::fabs(p.y));
    }
    figure.panels.push_back(std::move(panel));
  }
  double at_rest = 0;
  for (Panel const& panel : figure.panels) {
    for (Curve const& curve : panel.curves) {
      for (Point const& p : curve.points) at_rest = std::fabs(p.y) > 0.01 * greatest ? std::max(at_rest, p.x) : at_rest;
    }
  }
  add_figure(document, std::move(figure));
  if (greatest == 0) return;
  document.say(fmt::format("The greatest torque is {} N m; from {} s on all are below 1% of it.",
                           significant(greatest, 4), significant(at_rest)));
}

/// When the angles jump, between the two rows in which pitch and roll both turn most, and the yaw there, the one
/// nearer to 90 deg.
std::optional<Point> jump_of(results::Series const& series, double from, double to) {
  auto const pitch = column_of(series, "b2.pitch"), roll = column_of(series, "b2.roll"),
             yaw = column_of(series, "b2.yaw");
  if (!pitch || !roll || !yaw) return {};
  auto const turn = [](double a, double b) { return std::fabs(std::remainder(a - b, 360)); };
  std::optional<Point> found;
  double most = 0;
  for (std::size_t i = 1; i < series.rows.size(); ++i) {
    auto const &before = series.rows[i - 1], &after = series.rows[i];
    if (before.size() != series.columns.size() || after.size() != before.size()) continue;
    if (before[0] < from || to < after[0]) continue;
    double const both = std::min(turn(before[*pitch], after[*pitch]), turn(before[*roll], after[*roll]));
    if (both <= most) continue;
    most = both;
    bool const is_nearer = std::fabs(after[*yaw]) > std::fabs(before[*yaw]);
    found = {(before[0] + after[0]) / 2, is_nearer ? after[*yaw] : before[*yaw]};
  }
  return found;
}

/// Large angles: a description jumps, the attitude does not.
void add_jump(Document& document, Facts const& facts) {
  constexpr double from = 0.3, to = 0.6;
  Record const* run = finest(facts, "ex2", from, to);
  if (!run) return;
  Figure figure{.name = "so3-jump",
                .caption = fmt::format("Craft 2 from large angles (ex2): Euler angles, and an entry of its rotation "
                                       "matrix. {}, {}.",
                                       method_of(run->of), control_of(run->of)),
                .columns = 2};
  for (auto const& [column, label] : {std::pair("b2.pitch", "pitch [deg]"), std::pair("b2.yaw", "yaw [deg]"),
                                      std::pair("b2.roll", "roll [deg]"), std::pair("b2.r23", "R_23")}) {
    Panel panel{.x = {"t [s]"}, .y = {label}};
    add_curve(panel,
              against_time(facts, *run, column, "craft 2", {.index = 3, .points = false}, {.from = from, .to = to}));
    figure.panels.push_back(std::move(panel));
  }
  auto const at = jump_of(*facts.series_of(*run, "history"), from, to);
  auto const angle = claimed(*run, "euler_jump"), entry = claimed(*run, "r23_jump");
  if (at && angle && entry) {
    document.say(fmt::format(
        "At {} s (the paper: about .5 s) craft 2's yaw is {} deg. Within 5 ms pitch and roll both turn by {} deg, "
        "while R_23 moves by {}{}.",
        significant(at->x), significant(at->y, 4), significant(*angle, 4), significant(*entry, 2),
        *angle > 90 && *entry < 0.01 ? ": the angles jump, the attitude does not" : ""));
  }
  add_figure(document, std::move(figure));
}

}  // namespace

void add_so3(Document& document, Facts const& facts) {
  if (!has_runs(facts, so3_cooperative().problem)) return;
  add_paper_head(document, facts, so3_cooperative());
  auto const all = timed_runs(facts), compared = contests(all);
  add_times(document, compared);
  add_command(document, all);
  document.heading(3, "Histories and findings");
  add_histories(document, facts, compared);
  add_torques(document, facts);
  add_jump(document, facts);
  add_so3_orders(document, facts);
}

}  // namespace polhode::report
