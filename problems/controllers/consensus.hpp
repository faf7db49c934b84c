#pragma once
/// Group consensus of rigid bodies: torques that pull together what bodies of a group do, in MRPs and body rates.
/// Source: Zhou, Wang, Liu, Zhao, Qi & Yan (2020), Scientia Sinica Technologica 50(5)
///   u_i = -G(sigma_i)^T sum_j a_ij (sigma_i - sigma_j) - sum_j a_ij (omega_i - omega_j)
/// Weights within a group are positive; those between groups have both signs and sum to 0 at each body.
#include "problems/mrp.hpp"

namespace polhode {

/// What a body hears, summed link by link; then the torque that answers.
template <class S>
struct ConsensusSum {
  Vec3<S> apart = zero<Vec3<S>>();  ///< sum_j a_ij (sigma_i - sigma_j)
  Vec3<S> slip = zero<Vec3<S>>();   ///< sum_j a_ij (omega_i - omega_j) [rad/s]

  /// One link: difference sigma_i - sigma_j in MRPs and omega_i - omega_j in body rates [rad/s].
  POLHODE_INLINE void hear(Real<S> const& a, Vec3<S> const& sigma, Vec3<S> const& omega) {
    add(apart, a, sigma);
    add(slip, a, omega);
  }
  /// u_i [N m, body axes] of the body at sigma.
  POLHODE_INLINE Vec3<S> torque(Vec3<S> const& sigma) const {
    return S(-1.0) * (mrp_rate_transposed(sigma, apart) + slip);
  }
};

}  // namespace polhode
