#include "bench/cell_result.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace polhode::bench {
namespace {

/// Thins a history to about 500 rows and puts the time in front.
results::Series history_series(Measured const& measured) {
  History const& history = measured.history;
  results::Series series{.cell = measured.record.cell, .name = "history", .columns = {"t"}, .units = {"s"}, .rows = {}};
  for (Column const& column : measured.columns) {
    series.columns.push_back(column.name);
    series.units.push_back(column.unit);
  }
  std::size_t const stride = std::max<std::size_t>(1, history.times.size() / 500);
  for (std::size_t i = 0; i < history.times.size(); ++i) {
    if (i % stride != 0 && i + 1 != history.times.size()) continue;
    std::vector<double> row{history.times[i]};
    row.insert(row.end(), history.rows[i].begin(), history.rows[i].end());
    series.rows.push_back(std::move(row));
  }
  return series;
}

}  // namespace

CellResult result_of(Measured measured, bool keep_history) {
  CellResult result;
  if (!measured.drift.rows.empty()) result.series.push_back(std::move(measured.drift));
  if (keep_history && !measured.history.rows.empty()) result.series.push_back(history_series(measured));
  if (keep_history && !measured.invariants.rows.empty()) result.series.push_back(std::move(measured.invariants));
  result.record = std::move(measured.record);
  return result;
}

std::string to_text(CellResult const& result) {
  auto const line = [](nlohmann::ordered_json const& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  };
  std::string text;
  for (results::Series const& series : result.series) text += line(results::to_json(series));
  return text + line(results::to_json(result.record));
}

CellResult cell_result_from(std::string const& text) {
  CellResult result;
  std::istringstream in(text);
  bool complete = false;
  for (std::string line; std::getline(in, line);) {
    auto const json = nlohmann::ordered_json::parse(line, nullptr, false);
    if (json.is_discarded()) break;
    complete = results::kind_of(json) == "run";
    if (complete)
      result.record = results::record_from_json(json);
    else
      result.series.push_back(results::series_from_json(json));
  }
  if (!complete) throw std::invalid_argument("a cell's result without its record");
  return result;
}

}  // namespace polhode::bench
