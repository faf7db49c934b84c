#pragma once
/// Certificates: references with their proof, as files in results/reference/.
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "bench/solve/state.hpp"

namespace polhode::bench {

/// A reference file that cannot be used: damaged, edited or stale. what() names the file and the remedy.
struct ReferenceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A reference with its proof.
struct Certificate {
  std::string id;  ///< hash of `subject`: problem, variant, parameters, horizon
  std::string subject;
  double bar = 0;                        ///< [rad]; without attitudes, of the rates
  double disagreement = 0, halving = 0;  ///< two of its parts [rad]
  /// The third: Taylor against the closed form [rad]; null if the problem has none.
  std::optional<double> closed_form{};
  Layout layout{};              ///< of the states
  std::vector<double> times{};  ///< where the states are stored [s]
  std::vector<QuadState> states{};
};

/// results/reference/ID.json: decimal digits and hex floats, bar, hash of the contents.
void save(Certificate const& certificate, std::filesystem::path const& folder);
/// Reads it back. Throws ReferenceError if it is damaged or was edited by hand.
Certificate load(std::filesystem::path const& file);

}  // namespace polhode::bench
