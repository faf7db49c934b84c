#pragma once
/// Every number of a problem is a named parameter with a unit, a default and a rule; `--set` and suite files change it.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace polhode {

/// The user's choice of a variant or a parameter cannot be: what() says which rule it breaks.
struct ParameterError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// What a parameter's values must satisfy.
enum class Rule { finite, positive, non_negative, inertia, unit_quaternion, graph };

/// One parameter, tied to the numbers that it sets. An inertia may change between 3 and 6 numbers, a graph has three
/// for every link (graph.hpp).
class Parameter {
 public:
  Parameter(std::string name, std::string unit, Rule rule, std::vector<double>& values)
      : name_(std::move(name)), unit_(std::move(unit)), rule_(rule), vector_(&values) {}
  Parameter(std::string name, std::string unit, Rule rule, double& value)
      : name_(std::move(name)), unit_(std::move(unit)), rule_(rule), single_(&value) {}

  std::string const& name() const { return name_; }
  std::string const& unit() const { return unit_; }
  std::vector<double> values() const { return single_ ? std::vector<double>{*single_} : *vector_; }
  /// Throws ParameterError that names the parameter and the rule.
  void assign(std::vector<double> const& values);

 private:
  [[noreturn]] void refuse(std::string const& why) const { throw ParameterError("parameter " + name_ + ": " + why); }
  void check(std::vector<double> const& values) const;
  void check_inertia(std::vector<double> const& values) const;

  std::string name_, unit_;
  Rule rule_;
  std::vector<double>* vector_ = nullptr;
  double* single_ = nullptr;
};

/// What a user chose of a problem: variant words, parameters, and the step size for variants that depend on it.
struct Choice {
  std::set<std::string> words;
  std::map<std::string, std::vector<double>> set;
  double step = 0;  ///< [s]; 0 for adaptive runs

  bool has(std::string const& word) const { return words.contains(word); }
};

/// Sets each chosen parameter. Names are known to be right. Throws ParameterError.
inline void assign(std::vector<Parameter> parameters, std::map<std::string, std::vector<double>> const& set) {
  for (Parameter& parameter : parameters) {
    auto const found = set.find(parameter.name());
    if (found != set.end()) parameter.assign(found->second);
  }
}

inline void Parameter::assign(std::vector<double> const& values) {
  std::size_t const wanted = single_ ? 1 : vector_->size();
  bool const other_inertia = rule_ == Rule::inertia && (values.size() == 3 || values.size() == 6);
  bool const links = rule_ == Rule::graph && !values.empty() && values.size() % 3 == 0;
  if (rule_ == Rule::graph && !links)
    refuse("takes 3 numbers a link (node, node that it hears, weight), not " + std::to_string(values.size()));
  if (values.size() != wanted && !other_inertia && !links)
    refuse("takes " + std::string(rule_ == Rule::inertia ? "3 or 6" : std::to_string(wanted)) + " number(s), not " +
           std::to_string(values.size()));
  check(values);
  if (single_)
    *single_ = values[0];
  else
    *vector_ = values;
}

inline void Parameter::check(std::vector<double> const& values) const {
  double squares = 0;
  for (double value : values) {
    if (!std::isfinite(value)) refuse("every number must be finite");
    if (rule_ == Rule::positive && !(value > 0)) refuse("must be greater than 0 " + unit_);
    if (rule_ == Rule::non_negative && !(value >= 0)) refuse("must not be negative");
    squares += value * value;
  }
  if (rule_ == Rule::unit_quaternion && std::fabs(squares - 1) > 0.02)
    refuse("|q|^2 must be within 2% of 1 (it is then normalised), not " + std::to_string(squares));
  if (rule_ == Rule::inertia) check_inertia(values);
}

namespace detail {
/// Are all eigenvalues of a symmetric matrix positive? They are if the pivots of its L D L^T are.
/// Source: Golub & Van Loan (2013), Matrix Computations, sec. 4.2
inline bool is_positive_definite(double xx, double yy, double zz, double xy, double xz, double yz) {
  double const second = yy - xy / xx * xy, below = yz - xy / xx * xz;
  double const third = zz - xz / xx * xz - below / second * below;
  return xx > 0 && second > 0 && third > 0;
}
}  // namespace detail

inline void Parameter::check_inertia(std::vector<double> const& v) const {
  double const xx = v[0], yy = v[1], zz = v[2];
  bool const full = v.size() == 6;
  double const xy = full ? v[3] : 0, xz = full ? v[4] : 0, yz = full ? v[5] : 0;
  if (!detail::is_positive_definite(xx, yy, zz, xy, xz, yz))
    refuse("principal moments of inertia must be greater than 0 kg m^2");
  // The eigenvalues of tr(J) 1 - 2 J are what two principal moments have in excess of the third: 0 for a lamina.
  double const rounding = 1e-12 * std::max({xx, yy, zz});
  if (!detail::is_positive_definite(yy + zz - xx + rounding, zz + xx - yy + rounding, xx + yy - zz + rounding, -2 * xy,
                                    -2 * xz, -2 * yz))
    refuse("breaks the triangle inequality: no principal moment may exceed the sum of the other two");
}

}  // namespace polhode
