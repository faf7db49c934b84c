#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>

#include "report/located.hpp"
#include "report/render/page.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using Json = nlohmann::json;
using results::Record;
using results::Series;

/// Attitude errors whose cost is asked [rad].
constexpr double targets[] = {1e-6, 1e-9, 1e-12};
/// A picture shows no more of a history than this.
constexpr std::size_t most_rows = 400;
/// Points per curve of a drift, which is drawn against log t.
constexpr int bins = 40;
/// Numbers of all histories together: what keeps the page small.
constexpr std::size_t most_numbers = 250'000;
/// Different bodies whose polhodes are drawn.
constexpr std::size_t most_spins = 8;

/// Texts that repeat, each once; a column holds their places.
class Dictionary {
 public:
  std::size_t of(std::string const& text) {
    auto const [at, is_new] = places_.try_emplace(text, texts_.size());
    if (is_new) texts_.push_back(one_line(text));
    return at->second;
  }
  std::vector<std::string> const& texts() const { return texts_; }

 private:
  std::unordered_map<std::string, std::size_t> places_;
  std::vector<std::string> texts_;
};

/// As many digits as a picture needs.
Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::stod(fmt::format("{:.5g}", value));
}

Json as_recorded(std::optional<double> value) {
  return finite(value) ? Json(*value) : Json(nullptr);
}

/// A visitor of a record's fields: one column per field, texts by their places.
struct Columns {
  std::map<std::string, Json> numbers;
  std::map<std::string, std::string> units;
  std::map<std::string, Dictionary> texts;
  std::map<std::string, Json> places;

  void number(std::string const& name, std::string const& unit, Json value) {
    Json& column = numbers[name];
    if (column.is_null()) column = Json::array();
    column.push_back(std::move(value));
    units[name] = unit;
  }
  void operator()(char const* name, char const* unit, std::optional<double> const& value) {
    number(name, unit, as_recorded(value));
  }
  void operator()(char const* name, char const* unit, std::optional<std::int64_t> const& value) {
    number(name, unit, value ? Json(*value) : Json(nullptr));
  }
  void operator()(char const* name, char const* unit, double const& value) { number(name, unit, as_recorded(value)); }
  void operator()(char const* name, char const* unit, std::int64_t const& value) { number(name, unit, value); }
  void operator()(char const* name, char const* unit, std::optional<results::CpuTime> const& time) {
    std::string const n = name;
    number(n, unit, time ? as_recorded(time->median) : Json(nullptr));
    number(n + "_low", unit, time ? as_recorded(time->low) : Json(nullptr));
    number(n + "_high", unit, time ? as_recorded(time->high) : Json(nullptr));
  }
  void operator()(char const* name, char const*, std::string const& text) {
    Json& column = places[name];
    if (column.is_null()) column = Json::array();
    column.push_back(texts[name].of(text));
  }
  void operator()(char const* name, char const* unit, results::Status const& status) {
    (*this)(name, unit, std::string(results::name_of(status)));
  }
  void operator()(char const*, char const*, std::map<std::string, std::vector<double>> const&) {}  // of the instance
  void operator()(char const*, char const*, std::map<std::string, results::Claim> const&) {}  // have their sections
};

Json records_of(Facts const& facts) {
  Columns columns;
  for (Record const* run : facts.runs) results::for_each_field(*run, columns);
  Json json{{"count", facts.runs.size()}, {"numbers", Json::object()}, {"texts", Json::object()}};
  for (auto& [name, column] : columns.numbers) {
    if (std::ranges::all_of(column, [](Json const& value) { return value.is_null(); })) continue;
    json["numbers"][name] = {{"unit", columns.units[name]}, {"values", std::move(column)}};
  }
  for (auto& [name, column] : columns.places) {
    json["texts"][name] = {{"words", columns.texts[name].texts()}, {"at", std::move(column)}};
  }
  return json;
}

using Places = std::unordered_map<Record const*, std::size_t>;

/// What an accuracy costs with this sweep: a row per target, [value, low, high, run, interpolated], null if missed.
Json costs_of(Sweep const& sweep, Measure measure, Places const& place) {
  Instance const alone{"", sweep.runs};
  Json rows = Json::array();
  for (double const target : targets) {
    auto const costs = ranking(alone, target, measure);
    if (costs.empty()) {
      rows.push_back(nullptr);
      continue;
    }
    Cost const& c = costs.front();
    rows.push_back({c.value, c.low, c.high, place.at(c.run), c.interpolated ? 1 : 0});
  }
  return rows;
}

Json order_json(Sweep const& sweep) {
  if (!sweep.like().h) return nullptr;
  std::vector<Record const*> ended;
  std::ranges::copy_if(sweep.runs, std::back_inserter(ended), [](Record const* run) { return is_ok(*run); });
  if (ended.empty()) return nullptr;
  auto const result = order_of(Sweep{ended});
  if (!result.fit) return {{"reason", result.reason}};
  auto const& fit = *result.fit;
  return {{"slope", fit.slope},
          {"half_width", as_recorded(fit.half_width)},
          {"points", fit.points},
          {"h_low", fit.h_low},
          {"h_high", fit.h_high}};
}

Json instances_of(Facts const& facts, Places const& place) {
  Json list = Json::array();
  for (Instance const& instance : facts.instances) {
    auto const& c = instance.like();
    Json sweeps = Json::array();
    for (Sweep const& sweep : instance.sweeps()) {
      Json runs = Json::array();
      for (Record const* run : sweep.runs) runs.push_back(place.at(run));
      sweeps.push_back({{"runs", std::move(runs)},
                        {"order", order_json(sweep)},
                        {"time", costs_of(sweep, Measure::time, place)},
                        {"evaluations", costs_of(sweep, Measure::evaluations, place)}});
    }
    Json set = Json::object();
    for (auto const& [name, values] : c.set) set[one_line(name)] = values;
    list.push_back({{"label", one_line(instance.label)},
                    {"t_end", c.t_end},
                    {"set", std::move(set)},
                    {"aside", is_aside(c)},
                    {"sweeps", std::move(sweeps)}});
  }
  return list;
}

Json integrators_of(Facts const& facts) {
  Json list = Json::object();
  for (Record const* run : facts.runs) {
    std::string const name = one_line(run->of.integrator);
    if (list.contains(name)) continue;
    auto const said = facts.contents.catalogue.find(run->of.integrator);
    bool const known = said != facts.contents.catalogue.end();
    list[name] = {{"rival", is_rival(name)},
                  {"look", facts.style_of(run->of).index},
                  {"family", known ? one_line(said->second.family) : ""}};
  }
  return list;
}

/// The rows of a history that are drawn.
std::vector<std::vector<double>> sampled(Series const& series) {
  std::vector<std::vector<double>> rows;
  std::size_t const stride = (series.rows.size() + most_rows - 1) / most_rows;
  for (std::size_t i = 0; i < series.rows.size(); i += std::max<std::size_t>(stride, 1)) rows.push_back(series.rows[i]);
  return rows;
}

/// The largest magnitudes in equal shares of log t: no peak is lost.
std::vector<std::vector<double>> envelope(Series const& series) {
  double first = INFINITY, last = 0;
  for (auto const& row : series.rows) {
    if (row.empty() || !(row[0] > 0) || !std::isfinite(row[0])) continue;
    first = std::min(first, row[0]);
    last = std::max(last, row[0]);
  }
  if (!(last > first)) return {};
  std::map<int, std::vector<double>> largest;
  for (auto const& row : series.rows) {
    if (row.size() != series.columns.size() || !(row[0] > 0) || !std::isfinite(row[0])) continue;
    int const bin = static_cast<int>(bins * std::log(row[0] / first) / std::log(last / first));
    auto& of = largest.try_emplace(bin, row.size(), NAN).first->second;
    of[0] = row[0];
    for (std::size_t k = 1; k < row.size(); ++k) of[k] = std::fmax(of[k], std::abs(row[k]));
  }
  std::vector<std::vector<double>> rows;
  for (auto& [bin, row] : largest) rows.push_back(std::move(row));
  return rows;
}

/// Histories first, then the drifts of every instance in turn, until the page is full.
std::vector<std::pair<Record const*, Series const*>> series_in_order(Facts const& facts) {
  std::map<std::string, Record const*> by_cell;
  for (Record const* run : facts.runs) by_cell[run->cell] = run;
  std::unordered_map<Record const*, std::size_t> turn;
  for (Instance const& instance : facts.instances) {
    std::size_t n = 0;
    for (Record const* run : instance.runs) turn[run] = n++;
  }
  std::vector<std::pair<Record const*, Series const*>> list;
  for (Series const& series : facts.contents.series) {
    auto const run = by_cell.find(series.cell);
    if (run == by_cell.end() || series.columns.empty()) continue;
    if (facts.series_of(*run->second, series.name) == &series) list.emplace_back(run->second, &series);
  }
  std::ranges::stable_sort(list, {}, [&](auto const& item) {
    return std::pair(item.second->name != "history", item.second->name == "history" ? 0 : turn.at(item.first));
  });
  return list;
}

Json series_json(Facts const& facts, Places const& place, std::size_t& left_out) {
  Json list = Json::array();
  std::size_t numbers = 0;
  for (auto const& [run, series] : series_in_order(facts)) {
    auto const rows = series->name == "history" ? sampled(*series) : envelope(*series);
    if (rows.empty()) continue;
    if (numbers + rows.size() * series->columns.size() > most_numbers) {
      ++left_out;
      continue;
    }
    numbers += rows.size() * series->columns.size();
    Json columns = Json::array();
    for (std::size_t k = 0; k < series->columns.size(); ++k) {
      Json values = Json::array();
      for (auto const& row : rows) values.push_back(k < row.size() ? rounded(row[k]) : Json(nullptr));
      columns.push_back({{"name", one_line(series->columns[k])},
                         {"unit", k < series->units.size() ? one_line(series->units[k]) : ""},
                         {"values", std::move(values)}});
    }
    list.push_back({{"run", place.at(run)}, {"name", one_line(series->name)}, {"columns", std::move(columns)}});
  }
  return list;
}

Json curve_json(RateCurve const& curve) {
  Json axes = Json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    Json values = Json::array();
    for (Triple const& w : curve) values.push_back(rounded(w[i]));
    axes.push_back(std::move(values));
  }
  return axes;
}

Json spins_json(std::vector<NamedSpin> const& spins) {
  Json list = Json::array();
  for (NamedSpin const& named : spins) {
    Json family = Json::array();
    for (RateCurve const& curve : polhode_family(named.spin)) family.push_back(curve_json(curve));
    list.push_back({{"label", one_line(named.label)},
                    {"inertia", named.spin.inertia},
                    {"axes", named.has_products ? Json(named.body.axes) : Json(nullptr)},
                    {"omega0", named.spin.omega0},
                    {"semi_axes", named.spin.semi_axes()},
                    {"own", curve_json(own_polhode(named.spin))},
                    {"family", std::move(family)}});
  }
  return list;
}

/// A parameter of several numbers, or the problem's own.
std::vector<double> values_of(results::Cell const& cell, std::string const& name, Triple const& usual) {
  auto const found = cell.set.find(name);
  return found == cell.set.end() ? std::vector(usual.begin(), usual.end()) : found->second;
}

}  // namespace

std::vector<NamedSpin> free_spins(Facts const& facts) {
  // The problems' own body: the target of the tether paper, after its capture.
  constexpr Triple usual_inertia{100, 120, 110};
  constexpr double degree = 3.14159265358979323846 / 180;
  constexpr Triple usual_omega0{10 * degree, 10 * degree, 10 * degree};
  std::vector<NamedSpin> spins;
  std::set<FreeSpin> seen;
  for (Instance const& instance : facts.instances) {
    auto const& c = instance.like();
    bool const torque_free = c.problem == "free_body" || (c.problem == "tether_capture" && has_word(c.variant, "free"));
    if (!torque_free) continue;
    auto const inertia = values_of(c, "inertia", usual_inertia), omega0 = values_of(c, "omega0", usual_omega0);
    bool const diagonal = inertia.size() == 3;
    if ((!diagonal && inertia.size() != 6) || omega0.size() != 3) continue;
    std::array<double, 6> entries{};
    std::ranges::copy(inertia, entries.begin());
    PrincipalAxes const body = principal_axes(entries);
    FreeSpin const spin{body.moments, body.components({omega0[0], omega0[1], omega0[2]})};
    bool const sound = std::ranges::all_of(spin.inertia, [](double j) { return j > 0 && std::isfinite(j); });
    if (sound && std::isfinite(spin.energy_twice()) && spins.size() < most_spins && seen.insert(spin).second) {
      spins.push_back({instance.label, spin, body, !diagonal});
    }
  }
  return spins;
}

Json page_data(Facts const& facts) {
  Places place;
  for (Record const* run : facts.runs) place[run] = place.size();
  std::size_t left_out = 0;
  Json json{{"targets", targets}, {"records", records_of(facts)}, {"integrators", integrators_of(facts)}};
  json["instances"] = instances_of(facts, place);
  json["series"] = series_json(facts, place, left_out);
  json["series_left_out"] = left_out;
  json["spins"] = spins_json(free_spins(facts));
  return json;
}

std::string script_safe(Json const& json) {
  std::string const text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (char const c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace polhode::report
