#include "bench/input/trajectory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <optional>

#include "bench/process/messages.hpp"
#include "bench/process/text.hpp"
#include "results/statistics.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench {
namespace {

constexpr std::size_t most_numbers = 50'000'000;
constexpr std::size_t longest_line = std::size_t{64} << 20;
constexpr double gap_factor = 10;  ///< a gap is this many times the median interval

/// "t, q1, q2, ...": all of them, if they are not too many.
std::string list_of(std::vector<std::string> const& names) {
  constexpr std::size_t most = 20;
  std::vector<std::string> shown(names.begin(), names.begin() + std::ptrdiff_t(std::min(names.size(), most)));
  return fmt::format("t, {}{}", fmt::join(shown, ", "), names.size() > most ? ", ..." : "");
}

/// Reads line by line, and turns lines into rows.
class Reader {
 public:
  Reader(std::istream& in, std::string const& name, ColumnNames const& wanted) : in_(in), wanted_(wanted) {
    table_.file = name;
    table_.width = wanted.required.size();
  }

  TrajectoryTable read() {
    while (next_line()) {
      if (names_.empty())
        read_header();
      else
        read_row();
    }
    if (in_.bad()) throw TrajectoryError(table_.file + ": cannot be read to its end");
    if (names_.empty())
      throw TrajectoryError(fmt::format("{}: has no header; its first line must name columns: {}", table_.file,
                                        list_of(wanted_.required)));
    if (table_.rows() < 2)
      throw TrajectoryError(
          fmt::format("{}: has {} row(s); a trajectory has at least two", table_.file, table_.rows()));
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse(std::string const& why) const {
    throw TrajectoryError(fmt::format("{}:{}: {}", table_.file, number_, why));
  }

  /// The next line that holds something; false at the end. Never more of it in memory than a line may have.
  bool next_line() {
    constexpr int end = std::istream::traits_type::eof();
    std::streambuf& bytes = *in_.rdbuf();
    while (in_.peek() != end) {
      ++number_;
      line_.clear();
      for (int c = bytes.sbumpc(); c != '\n' && c != end; c = bytes.sbumpc()) {
        if (line_.size() == longest_line) refuse("longer than 64 MiB: not a table of numbers");
        line_ += char(c);
      }
      if (number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.erase(0, 3);
      std::string_view const text = trimmed(line_);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }

  void read_header() {
    auto const fields = fields_of(line_);
    names_.assign(fields.begin(), fields.end());
    if (names_.size() == 1 && names_[0].find_first_of(";\t ") != std::string::npos)
      refuse("columns are to be separated by commas");
    bool const numbers = std::ranges::all_of(names_, [](auto const& name) { return number_in(name).has_value(); });
    if (numbers)
      refuse("numbers where the header is expected: the first line must name columns: " + list_of(wanted_.required));
    std::vector<std::string> known{"t"};
    known.insert(known.end(), wanted_.required.begin(), wanted_.required.end());
    known.insert(known.end(), wanted_.optional.begin(), wanted_.optional.end());
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (std::ranges::find(known, names_[i]) == known.end())
        refuse(fmt::format("column {}: {}", i + 1, unknown("column", names_[i], known)));
      if (std::find(names_.begin(), names_.begin() + std::ptrdiff_t(i), names_[i]) !=
          names_.begin() + std::ptrdiff_t(i))
        refuse(fmt::format("column {}: {} is named twice", i + 1, quote(names_[i])));
    }
    time_ = place_of("t");
    for (std::string const& name : wanted_.required) places_.push_back(place_of(name));
  }
  std::size_t place_of(std::string const& name) const {
    auto const found = std::ranges::find(names_, name);
    if (found == names_.end())
      refuse(fmt::format("column '{}' is missing; there must be {}", name, list_of(wanted_.required)));
    return std::size_t(found - names_.begin());
  }

  void read_row() {
    auto const fields = fields_of(line_);
    if (fields.size() != names_.size())
      refuse(fmt::format("{} value(s), but the header names {} columns", fields.size(), names_.size()));
    if (table_.values.size() + table_.width > most_numbers)
      refuse(fmt::format("more than {} numbers; leave out some rows", most_numbers));
    row_.clear();
    for (std::size_t i = 0; i < fields.size(); ++i) row_.push_back(number_at(i, fields[i]));
    if (row_[time_] < 0)
      refuse(fmt::format("column {} (t): {} s; a trajectory begins at 0 s or later", time_ + 1, row_[time_]));
    table_.times.push_back(row_[time_]);
    table_.lines.push_back(number_);
    for (std::size_t const place : places_) table_.values.push_back(row_[place]);
  }
  double number_at(std::size_t column, std::string_view field) const {
    auto const refuse_field = [&](std::string const& why) {
      refuse(fmt::format("column {} ({}): {}", column + 1, names_[column], why));
    };
    if (field.empty()) refuse_field("no value; a number is expected");
    std::optional<double> const value = number_in(field);
    if (!value) refuse_field(quote(field) + " is not a number");
    if (!std::isfinite(*value)) refuse_field(quote(field) + " is not finite");
    return *value;
  }
  /// What is too large for a double is infinite.
  static std::optional<double> number_in(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size()) return {};
    if (error == std::errc()) return value;
    if (error != std::errc::result_out_of_range) return {};
    bool const tiny = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos;
    return tiny ? 0 : std::numeric_limits<double>::infinity();
  }

  std::istream& in_;
  ColumnNames const& wanted_;
  TrajectoryTable table_;
  std::size_t number_ = 0;  ///< of the line
  std::string line_;
  std::vector<std::string> names_;
  std::size_t time_ = 0;
  std::vector<std::size_t> places_;  ///< of the required columns
  std::vector<double> row_;
};

void sort_by_time(TrajectoryTable& table) {
  std::size_t out_of_order = 0, first = 0;
  for (std::size_t i = 1; i < table.rows(); ++i) {
    if (!(table.times[i] < table.times[i - 1])) continue;
    if (out_of_order++ == 0) first = table.lines[i];
  }
  if (out_of_order == 0) return;
  table.remarks.push_back(
      fmt::format("times go back at {} row(s), first at line {}: the rows were sorted", out_of_order, first));
  std::vector<std::size_t> order(table.rows());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return table.times[i]; });
  TrajectoryTable sorted = table;
  for (std::size_t k = 0; k < order.size(); ++k) {
    sorted.times[k] = table.times[order[k]];
    sorted.lines[k] = table.lines[order[k]];
    std::ranges::copy(table.row(order[k]), sorted.values.begin() + std::ptrdiff_t(k * table.width));
  }
  table = std::move(sorted);
}

void note_duplicates(TrajectoryTable& table) {
  std::size_t duplicates = 0, first = 0;
  for (std::size_t i = 1; i < table.rows(); ++i)
    if (table.times[i] == table.times[i - 1] && duplicates++ == 0) first = i;
  if (duplicates == 0) return;
  table.remarks.push_back(
      fmt::format("{} row(s) repeat the time of another, first t = {:g} s in lines {} and {}: all of "
                  "them count",
                  duplicates, table.times[first], table.lines[first - 1], table.lines[first]));
}

void note_gaps(TrajectoryTable& table) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < table.rows(); ++i)
    if (table.times[i] > table.times[i - 1]) intervals.push_back(table.times[i] - table.times[i - 1]);
  if (intervals.empty()) return;
  double const typical = results::median(std::move(intervals));
  std::size_t gaps = 0, widest = 0;
  double width = 0;
  for (std::size_t i = 1; i < table.rows(); ++i) {
    double const interval = table.times[i] - table.times[i - 1];
    if (!(interval > gap_factor * typical)) continue;
    ++gaps;
    if (interval > width) width = interval, widest = i;
  }
  if (gaps == 0) return;
  table.remarks.push_back(
      fmt::format("{} gap(s) in time, the widest of {:g} s before line {} (the median interval is "
                  "{:g} s): nothing is known of errors inside",
                  gaps, width, table.lines[widest], typical));
}

}  // namespace

TrajectoryTable read_trajectory(std::istream& in, std::string const& name, ColumnNames const& wanted) {
  TrajectoryTable table = Reader(in, name, wanted).read();
  sort_by_time(table);
  note_duplicates(table);
  note_gaps(table);
  return table;
}

TrajectoryTable read_trajectory(std::filesystem::path const& file, ColumnNames const& wanted) {
  std::ifstream in;
  try {
    in = results::open_regular(file);
  } catch (results::StoreError const& error) {
    throw TrajectoryError(error.what());
  }
  return read_trajectory(in, file.string(), wanted);
}

}  // namespace polhode::bench
