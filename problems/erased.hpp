#pragma once
/// A problem with its type forgotten, counting its evaluations. Methods are then compiled once per space for all
/// problems on it: for measured runs (where counting is wanted and speed is not), references in long floats, and
/// inertia matrices. Costs a virtual call per evaluation: an RK4 step of a free body takes 2.4x as long. Timed runs use
/// the typed field.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "problems/jet.hpp"
#include "problems/pinned_body.hpp"
#include "problems/problem.hpp"

namespace polhode {

template <Space M>
class Erased;
/// A body on power series of the degree that the method `taylor` takes.
using SeriesTwin = Erased<RigidBody<FlatQuaternion<Jet<double, 20>>>>;

/// What the problems of one space show beside what all have: nothing,
template <class M>
class ErasedExtras {};
/// or what methods for rigid bodies ask (integrators/rigid_motion.hpp), if the problem is one under Euler's equation,
template <Attitude A>
class ErasedExtras<RigidBody<A>> {
  using S = typename A::Scalar;

 public:
  /// The attitude turns with the body rate, and the inertia is known; else the others must not be asked.
  virtual bool is_rigid_body() const = 0;
  virtual Mat3<Real<S>> inertia_matrix() const = 0;  ///< [kg m^2, body]
  virtual bool torque_free() const = 0;
  virtual bool torque_feels_rate() const = 0;
  /// The same problem on power series; null if it is not known.
  virtual SeriesTwin const* series() const = 0;
  SeriesTwin const& in_series() const requires std::same_as<A, FlatQuaternion<double>> { return *series(); }
  /// [N m, body]; counts as an evaluation.
  virtual Vec3<S> torque(S const& t, Point<RigidBody<A>> const& x) const = 0;

 protected:
  ~ErasedExtras() = default;
};
/// or whether the rates of attitudes depend on time alone,
template <Attitude A>
class ErasedExtras<Attitudes<A>> {
 public:
  virtual bool prescribed_rates() const = 0;

 protected:
  ~ErasedExtras() = default;
};
/// or the mechanics of a constrained body, for methods that solve for the constraint.
template <Attitude A>
class ErasedExtras<MovingBody<A>> {
 public:
  virtual PinnedBody<typename A::Scalar> const& mechanics() const = 0;

 protected:
  ~ErasedExtras() = default;
};

/// What the run loop needs of a problem on space M.
template <Space M>
class Erased : public ErasedExtras<M> {
 public:
  using Space = M;
  using S = typename M::Scalar;

  virtual ~Erased() = default;
  virtual Point<M> initial() const = 0;
  /// A new run: what controllers remember and the sides that are held are forgotten.
  virtual void begin() = 0;
  /// Takes a sample: the held torque changes. Nothing for continuous problems.
  virtual void sample(Real<S> const& t, Point<M> const& x) = 0;
  /// Writes the problem's own columns; only runs in double show anything.
  virtual void show(Real<S> const& t, Point<M> const& x, std::span<double> out) const = 0;
  /// Announced times at which the field is not smooth [s], ascending: steps land on them, methods restart.
  virtual std::vector<double> time_events() const = 0;
  /// The event at t has come: from now on the field is that of the next phase. A problem with time events switches here
  /// and not by comparing t, for the last stage of the step before the event looks at the field at t, too.
  virtual void enter_phase(Real<S> const& t) = 0;
  /// See SwitchingProblem; 0 events and nothing to do for smooth problems.
  virtual int state_events() const = 0;
  virtual void event_values(S const& t, Point<M> const& x, std::span<S> g) const = 0;
  virtual void take_sides(Real<S> const& t, Point<M> const& x) = 0;
  virtual void cross(int k) = 0;
  /// The derivative of the rate in flat coordinates, by columns, for problems that know it (dual_field.hpp).
  virtual bool has_jacobian() const = 0;
  virtual void jacobian(Real<S> const& t, Point<M> const& x, std::span<double> J) const = 0;

  Velocity<M> operator()(S const& t, Point<M> const& x) const requires SmallSpace<M> {
    Velocity<M> v;
    count();
    evaluate(t, x, v);
    return v;
  }
  void operator()(S const& t, Point<M> const& x, Velocity<M>& v) const requires PowerSpace<M> {
    count();
    evaluate(t, x, v);
  }
  std::int64_t evaluations() const { return evaluations_; }

 protected:
  void count() const { ++evaluations_; }
  virtual void evaluate(S const& t, Point<M> const& x, Velocity<M>& v) const = 0;

 private:
  mutable std::int64_t evaluations_ = 0;
};

/// Owns a problem,
template <Problem P>
class Owning : public Erased<typename P::Space> {
 protected:
  explicit Owning(P problem) : problem_(std::move(problem)) {}
  P problem_;
};
/// and shows what only those of its space show.
template <Problem P, class M = typename P::Space>
class Erasing : public Owning<P> {
 protected:
  using Owning<P>::Owning;
  using Owning<P>::problem_;
};
template <Problem P, Attitude A>
class Erasing<P, RigidBody<A>> : public Owning<P> {
  using S = typename A::Scalar;
  static constexpr bool rigid = requires(P const& p) { p.inertia_matrix(); };

 public:
  bool is_rigid_body() const override {
    if constexpr (rigid)
      return problem_.is_rigid_body();
    else
      return false;
  }
  Mat3<Real<S>> inertia_matrix() const override {
    if constexpr (rigid)
      return problem_.inertia_matrix();
    else
      return {};
  }
  SeriesTwin const* series() const override {
    if constexpr (requires { problem_.series(); })
      return problem_.series();
    else
      return nullptr;
  }
  bool torque_free() const override {
    if constexpr (rigid)
      return problem_.torque_free();
    else
      return false;
  }
  bool torque_feels_rate() const override {
    if constexpr (rigid)
      return problem_.torque_feels_rate();
    else
      return true;
  }
  Vec3<S> torque([[maybe_unused]] S const& t, [[maybe_unused]] Point<RigidBody<A>> const& x) const override {
    this->count();
    if constexpr (rigid)
      return problem_.torque(t, x);
    else
      return {};
  }

 protected:
  using Owning<P>::Owning;
  using Owning<P>::problem_;
};
template <Problem P, Attitude A>
class Erasing<P, Attitudes<A>> : public Owning<P> {
 public:
  bool prescribed_rates() const override {
    if constexpr (requires { problem_.prescribed_rates(); })
      return problem_.prescribed_rates();
    else
      return false;
  }

 protected:
  using Owning<P>::Owning;
  using Owning<P>::problem_;
};
template <Problem P, Attitude A>
class Erasing<P, MovingBody<A>> : public Owning<P> {
 public:
  PinnedBody<typename A::Scalar> const& mechanics() const override { return problem_.mechanics(); }

 protected:
  using Owning<P>::Owning;
  using Owning<P>::problem_;
};

/// Problem P as its space alone: what the slow form of a run calls, virtually.
template <Problem P>
class ErasedAs final : public Erasing<P> {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using Erasing<P>::problem_;

 public:
  explicit ErasedAs(P problem) : Erasing<P>(std::move(problem)), fresh_(problem_) {}
  void begin() override {
    if constexpr (requires { problem_.begin(); })
      problem_.begin();
    else
      problem_ = fresh_;
  }
  Point<M> initial() const override { return problem_.initial(); }
  void sample([[maybe_unused]] Real<S> const& t, [[maybe_unused]] Point<M> const& x) override {
    if constexpr (SampledProblem<P>) problem_.sample(t, x);
  }
  void show([[maybe_unused]] Real<S> const& t, [[maybe_unused]] Point<M> const& x,
            [[maybe_unused]] std::span<double> out) const override {
    if constexpr (!std::same_as<S, double>)
      return;
    else if constexpr (requires { problem_.show(t, x, out); })
      problem_.show(t, x, out);
    else if constexpr (requires { problem_.show(x, out); })
      problem_.show(x, out);
  }
  std::vector<double> time_events() const override {
    if constexpr (requires { problem_.time_events(); })
      return problem_.time_events();
    else
      return {};
  }
  void enter_phase([[maybe_unused]] Real<S> const& t) override {
    if constexpr (requires { problem_.enter_phase(t); }) problem_.enter_phase(t);
  }
  int state_events() const override {
    if constexpr (SwitchingProblem<P>)
      return problem_.state_events();
    else
      return 0;
  }
  void event_values([[maybe_unused]] S const& t, [[maybe_unused]] Point<M> const& x,
                    [[maybe_unused]] std::span<S> g) const override {
    if constexpr (SwitchingProblem<P>) problem_.event_values(t, x, g);
  }
  void take_sides([[maybe_unused]] Real<S> const& t, [[maybe_unused]] Point<M> const& x) override {
    if constexpr (SwitchingProblem<P>) problem_.take_sides(t, x);
  }
  void cross([[maybe_unused]] int k) override {
    if constexpr (SwitchingProblem<P>) problem_.cross(k);
  }
  bool has_jacobian() const override {
    if constexpr (requires { problem_.has_jacobian(); })
      return problem_.has_jacobian();
    else
      return false;
  }
  void jacobian([[maybe_unused]] Real<S> const& t, [[maybe_unused]] Point<M> const& x,
                [[maybe_unused]] std::span<double> J) const override {
    if constexpr (requires { problem_.jacobian(t, x, J); }) problem_.jacobian(t, x, J);
  }

 protected:
  void evaluate(S const& t, Point<M> const& x, Velocity<M>& v) const override {
    if constexpr (PowerSpace<M>)
      problem_(t, x, v);
    else
      v = problem_(t, x);
  }

 private:
  struct Nothing {
    explicit Nothing(P const&) {}
  };
  std::conditional_t<std::copyable<P>, P const, Nothing> fresh_;
};

template <Problem P>
std::unique_ptr<Erased<typename P::Space>> erase_type(P problem) {
  return std::make_unique<ErasedAs<P>>(std::move(problem));
}

}  // namespace polhode
