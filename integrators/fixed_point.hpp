#pragma once
/// Where an iteration ends: at rest, when only rounding errors move it. No tolerance, in any precision.
/// Source: Hairer, McLachlan & Razakarivony (2008), BIT 48, 231
#include "problems/vectors.hpp"

namespace polhode {

/// At rest when the greatest change of a sweep has had no new minimum twice running, or there was none.
template <class S>
class AtRest {
 public:
  /// After a sweep, by its greatest change.
  POLHODE_INLINE void see(S const& change) {
    idle_ = change == S(0.0) ? 2 : change < least_ ? 0 : idle_ + 1;
    least_ = change < least_ ? change : least_;
  }
  POLHODE_INLINE explicit operator bool() const { return idle_ >= 2; }

 private:
  S least_{1e300};
  int idle_ = 0;
};

/// The same made stricter: not one component of a vector V has a new minimum.
template <class V>
class AtRestByComponent {
 public:
  /// least: storage like the changes.
  POLHODE_INLINE explicit AtRestByComponent(V& least) : least_(least) { fill(least_, 1e300); }
  POLHODE_INLINE void see(V const& change) {
    bool smaller = false, still = true;
    V::each(
        [&](auto& low, auto const& now) POLHODE_LAMBDA {
          using S = std::decay_t<decltype(now)>;
          still = still && now == S(0.0);
          smaller = smaller || now < low;
          low = now < low ? now : low;
        },
        least_, change);
    idle_ = still ? 2 : smaller ? 0 : idle_ + 1;
  }
  POLHODE_INLINE explicit operator bool() const { return idle_ >= 2; }

 private:
  V& least_;
  int idle_ = 0;
};

/// At rest through round-off the last change is tiny against what is solved for; at rest because the iteration diverges
/// it is not.
template <class S>
POLHODE_INLINE bool is_solved(S const& change, S const& size) {
  return change < S(1e-9) * size + S(1e-12);
}

}  // namespace polhode
