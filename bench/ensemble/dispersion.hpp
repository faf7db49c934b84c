#pragma once
/// Parameters that differ from sample to sample of an ensemble: what the user asks for, and what each sample gets.
///
/// A sample's numbers are a function of the seed, the sample, and the parameter's name and component: neither threads
/// nor ranks nor other dispersions change them, and any one sample can be had alone.
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {

/// The law of one number, or of an attitude.
struct Distribution {
  enum class Kind {
    normal,       ///< a: mean, b: standard deviation
    uniform,      ///< from a to b
    log_uniform,  ///< the logarithm uniform from that of a to that of b
    so3           ///< a quaternion, uniform on the rotation group (Haar's measure)
  };
  Kind kind = Kind::normal;
  double a = 0, b = 0;
};

/// One --disperse: a distribution for a parameter, each of its components by itself, or for one component.
struct Dispersion {
  std::string text;       ///< canonical: "omega0.x=normal(0.1,0.02)"
  std::string parameter;  ///< "omega0"
  int component = -1;     ///< from 0; -1: all
  Distribution distribution;
};

/// All dispersions of an ensemble.
class Dispersions {
 public:
  Dispersions() = default;
  /// Reads NAME=DISTRIBUTION or NAME.COMPONENT=DISTRIBUTION, the component x, y, z (w) or 1, 2, ...; the distribution
  /// normal(MEAN,SIGMA), uniform(A,B), log_uniform(A,B) or so3(), which is for q0 alone, as q0 is for it. Components
  /// that are not dispersed are those of `set` or the problem's own. Throws UsageError: what is wrong, what would be
  /// right.
  Dispersions(ProblemWord const& problem, std::map<std::string, std::vector<double>> const& set,
              std::vector<std::string> const& texts, std::uint64_t seed);

  std::vector<Dispersion> const& list() const { return list_; }
  /// The parameters that differ, each once, and what every one of them is before its components are drawn.
  std::vector<std::string> const& parameters() const { return names_; }
  std::vector<std::vector<double>> const& undispersed() const { return base_; }
  /// Writes the numbers of one sample: values[i] are those of parameters()[i], with the length of undispersed()[i].
  void draw(std::int64_t sample, std::vector<std::vector<double>>& values) const;
  /// `set` with the numbers of one sample in it.
  std::map<std::string, std::vector<double>> with_sample(std::map<std::string, std::vector<double>> set,
                                                         std::int64_t sample) const;
  /// The ends of a dispersion's support, or a normal law's mean: what a rule of the parameter must allow.
  std::map<std::string, std::vector<double>> with_end(std::map<std::string, std::vector<double>> set,
                                                      Dispersion const& of, bool upper) const;

 private:
  std::size_t place_of(std::string const& parameter) const;

  std::uint64_t seed_ = 0;
  std::vector<Dispersion> list_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> base_;
};

}  // namespace polhode::bench
