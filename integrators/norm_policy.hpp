#pragma once
/// What is done about the norm at the border of a step: an axis of its own, not a property of a method.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "problems/space.hpp"

namespace polhode {

enum class NormPolicy {
  none,     ///< nothing: the undisturbed method
  project,  ///< the nearest point of the constraint after every step. For quaternions the tether paper's explicit
            ///< projection, eq. (16), which is renormalisation
};

/// The policies by their words.
struct PolicyName {
  NormPolicy policy;
  std::string_view name;
};
inline constexpr std::array policy_names{PolicyName{NormPolicy::none, "none"},
                                         PolicyName{NormPolicy::project, "project"}};

/// What projection did: it never hides the raw drift.
struct Projections {
  std::int64_t count = 0;
  double raw_defect = 0;  ///< the greatest defect that a step had before its projection
  double work = 0;        ///< accumulated distance moved

  /// Projects x onto the constraint of M.
  template <Space M>
  POLHODE_INLINE void apply(Point<M>& x) {
    double const defect = double(M::defect(x));
    raw_defect = defect > raw_defect ? defect : raw_defect;
    work += double(M::project(x));
    ++count;
  }
};

}  // namespace polhode
