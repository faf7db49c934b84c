#pragma once
/// A problem chosen by words and numbers, and its field, as tests of single problems want them.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "problems/definition.hpp"

namespace polhode::test {

using Real3 = Vec3<double>;
using Words = std::set<std::string>;
using Numbers = std::map<std::string, std::vector<double>>;

/// Chooses problem D and makes its fields, fully typed.   A  attitude, S  scalar
template <Definition D>
struct Chooser {
  D operator()(Words const& words, Numbers const& set = {}) const { return D(Choice{.words = words, .set = set}); }

  template <template <class> class A = FlatQuaternion, class S = double>
  auto field(Words const& words, Numbers const& set = {}) const {
    return (*this)(words, set).template field<S, A, true>();
  }
};
inline void expect_near(Real3 const& a, Real3 const& b, double tolerance, std::string const& what = "") {
  EXPECT_LE(distance<double>(a, b), tolerance) << what << " (" << a.x << ", " << a.y << ", " << a.z << ")";
}

}  // namespace polhode::test
