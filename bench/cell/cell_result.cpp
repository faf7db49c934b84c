#include "bench/cell/cell_result.hpp"

#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace polhode::bench {
CellResult result_of(Measured measured, bool keep_history) {
  CellResult result;
  if (!measured.drift.rows.empty()) result.series.push_back(std::move(measured.drift));
  constexpr std::size_t rows_kept = 500;
  if (keep_history && !measured.history.rows.empty())
    result.series.push_back(history_series(measured.record.cell, measured.columns, measured.history, rows_kept));
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
