#pragma once
// A problem that does not say how long it lasts.
// expected: Definition: a member of the problem is missing or of another type
#include "problems/free_body.hpp"

namespace polhode {

class Entry {
 public:
  explicit Entry(Choice const& choice) : free_(choice) {}
  static ProblemInfo const& info() { return FreeBody::info(); }
  std::vector<Parameter> parameters() { return free_.parameters(); }
  double sample_period = 0;
  bool torque_free() const { return true; }
  std::vector<Column> columns() const { return {}; }
  std::vector<ClaimResult> claims(History const&) const { return {}; }
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return free_.field<S, A, fast>();
  }

 private:
  FreeBody free_;
};

}  // namespace polhode
