#pragma once
/// The norm policies that change the step itself, on one flat quaternion: relaxation and project_symmetric.
#include "integrators/method.hpp"

namespace polhode {

/// Equal steps, and under the two policies steps that the policy has changed.
///   Steps  a driver of equal steps, which has run(), divide(), memory() and take_back() for those derived from it
/// fails   Status::nonlinear_fail, too, if there was no gamma or mu since the last restart
template <class Steps>
class NormSteps : public Steps {
  using M = typename Steps::Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  using Steps::Steps;

  Status advance(Point<M>& x, R t, R t_end) {
    if (moves_time()) [[unlikely]] {
      Status status = Status::ok;
      while (status == Status::ok && t != t_end) status = relaxed_step(x, t, t_end);
      return status;
    }
    if (is_symmetric()) [[unlikely]] {
      this->divide(t, t_end, [&](R const& from, R const& h, std::int64_t n) {
        for (std::int64_t i = 0; i < n; ++i) symmetric_step(x, from + R(double(i)) * h, h);
      });
      return changed_health(x);
    }
    return Steps::advance(x, t, t_end);
  }
  /// One step to t_end, however long.
  Status one_step(Point<M>& x, R t, R t_end) {
    if (moves_time()) [[unlikely]]
      take_relaxed(x, t, t_end - t, true);
    else if (is_symmetric()) [[unlikely]]
      symmetric_step(x, t, t_end - t);
    else
      return Steps::one_step(x, t, t_end);
    return changed_health(x);
  }
  /// The policy is relaxation: a step of h ends gamma h later.
  bool moves_time() const { return this->policy_ == NormPolicy::relaxation; }
  /// If moves_time(): one step in relaxed time, not beyond t_end. The last before t_end is up to a tenth longer, or
  /// shorter: none is left that is tiny.
  Status relaxed_step(Point<M>& x, R& t, R t_end) {
    R const left = t_end - t, h = this->step();
    bool const lands = double(left / h) <= relaxed_reach;
    R const moved = take_relaxed(x, t, lands ? left : h, lands);
    t = lands ? t_end : R(t + moved);
    return changed_health(x);
  }
  void restart() {
    Steps::restart();
    unprojected_ = false;
  }

 private:
  bool is_symmetric() const { return this->policy_ == NormPolicy::project_symmetric; }
  Status changed_health(Point<M> const& x) const {
    Status const status = this->health(all_finite(x));
    return status == Status::ok && unprojected_ ? Status::nonlinear_fail : status;
  }
  /// One step from (t, x) in relaxed time: of length h, or ending h later. Returns gamma h. A step that lands is taken
  /// again with the length that ends there but for O(h^(2p-1)): merely forgetting that its time is gamma h, as
  /// Ketcheson's IDT does, would cost an order where every step lands.
  R take_relaxed(Point<M>& x, R const& t, R h, bool lands) {
    Point<M> const before = x;
    auto const memory = this->memory();
    this->run(x, t, h, 1);
    R excess = relaxation_less_one<M>(before, x);
    if (lands && excess != R(0.0) && can_relax(excess)) {
      this->take_back(memory);
      x = before;
      h = h / (R(1.0) + excess);
      this->run(x, t, h, 1);
      excess = relaxation_less_one<M>(before, x);
    }
    if (!can_relax(excess)) unprojected_ = true;
    this->projections_.template relax<M>(before, x, excess);
    return h + excess * h;
  }
  /// One step of project_symmetric: (1 + mu) q is where it begins, q' / (1 - mu) where it ends, |q'| = 1 - mu.
  /// Simplified Newton for mu, whose matrix is 2, until round-off.
  void symmetric_step(Point<M>& x, R const& t, R const& h) {
    Point<M> const before = x;
    auto const memory = this->memory();
    S mu(0.0), least(1e300);
    S const rounding(std::same_as<S, double> ? 0x1p-52 : 0x1p-111);
    double raw = 0;
    for (int pass = 0;; ++pass) {
      if (pass > 0) {
        this->take_back(memory);
        x = before;
        add(x.first, mu, before.first);
      }
      this->run(x, t, h, 1);
      if (pass == 0) raw = double(M::defect(x));
      S const residual = norm_less_one(x.first) + mu, size = abs_of(residual);
      if (!(rounding < size && size < S(0.5) * least) || pass == 20) {
        if (!(size < S(1e-9))) unprojected_ = true;
        break;
      }
      least = size;
      mu -= S(0.5) * residual;
    }
    UnitQuaternion<S>::project(x.first);  // q' / (1 - mu), to the last bit
    this->projections_.note(raw, 2 * std::fabs(double(mu)));
  }

  bool unprojected_ = false;  ///< there was no gamma or mu
};

}  // namespace polhode
