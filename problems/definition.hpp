#pragma once
/// The run-time face of a problem: its name, words, parameters and claims, and the fields that it makes.
///
/// A problem is one header with a type that meets `Definition`, and one line in catalog.hpp. Nothing else is told.
#include <optional>
#include <string>
#include <vector>

#include <cmath>

#include "problems/erased.hpp"
#include "problems/parameters.hpp"

namespace polhode {

/// A published statement that a run can be held against.
struct ClaimInfo {
  std::string name;
  std::string statement;            ///< in our words
  std::optional<double> published;  ///< null if it is not a number
  std::string unit;
};

/// One claim after a run.
struct ClaimResult {
  std::string name;
  std::optional<double> value, published;
  std::optional<bool> holds;  ///< null: nothing is printed to hold it against
};

/// The facts of a problem that do not depend on the user's choice.
struct ProblemInfo {
  std::string name;     ///< the word on the command line
  std::string summary;  ///< one sentence
  std::string source;
  std::vector<std::vector<std::string>> variants;  ///< groups that exclude each other; the first is the default
  std::vector<std::string> events;                 ///< what a method would have to locate or land on
  std::vector<ClaimInfo> claims;
  std::vector<std::string> driven{};  ///< variant words that change how a run is driven, not what it is held against
};

/// Columns against time, as `simulate` prints them: rows[i] belongs to times[i].
struct History {
  std::vector<double> times;         ///< [s]
  std::vector<std::string> columns;  ///< q1 q2 q3 q4 wx wy wz and the problem's own
  std::vector<std::vector<double>> rows;

  /// The values of one column. Throws std::out_of_range for an unknown name.
  std::vector<double> column(std::string const& name) const;
};

/// D(choice) is a problem as chosen; it throws ParameterError when the choice cannot be.
///   info()                 the facts above
///   parameters()           name, unit, default, rule
///   horizon, sample_period [s]; 0 = continuous control
///   torque_free()          energy and angular momentum are invariants
///   principal()            the fast form of the inertia serves
///   columns()              what the problem shows beside its state
///   claims(history)        the claims, evaluated
///   field<S, A, fast>()    the problem in scalar S and attitude space A
template <class D>
concept Definition = std::constructible_from<D, Choice const&> && requires(D d, D const c, History const& history) {
  { D::info() } -> std::convertible_to<ProblemInfo const&>;
  { d.parameters() } -> std::same_as<std::vector<Parameter>>;
  { c.horizon } -> std::convertible_to<double>;
  { c.sample_period } -> std::convertible_to<double>;
  { c.torque_free() } -> std::same_as<bool>;
  { c.principal() } -> std::same_as<bool>;
  c.body();
  { c.columns() } -> std::same_as<std::vector<Column>>;
  { c.claims(history) } -> std::same_as<std::vector<ClaimResult>>;
  { c.template field<double, FlatQuaternion, true>() } -> Problem;
};

/// The field of a definition with its type forgotten.
template <Scalar S, template <class> class A, Definition D>
auto erase(D const& definition) {
  if (definition.principal()) return erase_type(definition.template field<S, A, true>());
  return erase_type(definition.template field<S, A, false>());
}

inline std::vector<double> History::column(std::string const& name) const {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] != name) continue;
    std::vector<double> values;
    for (auto const& row : rows) values.push_back(row[i]);
    return values;
  }
  throw std::out_of_range("no column " + name);
}

}  // namespace polhode
