#pragma once
/// The flags with which a command line names a cell, or its physics alone.
#include <CLI/App.hpp>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {

/// An option that takes a number; CLI11 by itself would read '' as 0.
CLI::Option* add_number(CLI::App& verb, std::string const& flag, double& value, std::string const& help);

/// The whole number that is the text of flag `name`. Throws UsageError with the range.
std::uint64_t whole_number(std::string_view name, std::string const& text, std::uint64_t least, std::uint64_t most);
/// The same of a flag that was read as a number.
int whole_number(std::string_view name, double value, int least, int most);

/// Parses "inertia=0.5,0.85,1". Throws UsageError.
std::pair<std::string, std::vector<double>> parse_setting(std::string const& text);

/// How many threads --threads may ask for.
inline constexpr int most_threads = 1024;

/// The flags that name one cell.
struct CellFlags {
  results::Cell cell;
  std::vector<std::string> settings;
  double h = 0, rtol = 0, atol = 0, t_end = 0;
  CLI::Option *has_h = nullptr, *has_rtol = nullptr, *has_atol = nullptr, *has_t_end = nullptr;

  /// `problem` is "PROBLEM", for a word without a flag, or "--problem".
  void add_physics(CLI::App& verb, std::string const& problem = "PROBLEM");
  void add_method(CLI::App& verb);
  /// The cell that the flags name. Throws UsageError.
  results::Cell chosen() const;
};

/// The same physics, with a method that serves where no run is wanted.
results::Cell physics_alone(results::Cell cell);

}  // namespace polhode::bench
