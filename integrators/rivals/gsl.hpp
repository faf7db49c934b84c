#pragma once
/// GSL's ordinary differential equations (odeiv2) behind our face, unmodified: Prince & Dormand's pair 8(7) and Adams
/// methods of variable order. Memory is made in bind and lives across advance calls. double, flat coordinates.
/// Linking GSL puts a binary under the GPL.
/// Source: Galassi et al., GNU Scientific Library Reference Manual, ch. "Ordinary Differential Equations"; GSL 2.7
#include "integrators/rivals/library_field.hpp"

#ifdef POLHODE_HAS_GSL
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <vector>
#endif

namespace polhode {

#ifdef POLHODE_HAS_GSL
inline constexpr std::string_view gsl_not_built = "";

/// Frees the library's objects.
struct GslFree {
  void operator()(gsl_odeiv2_driver* driver) const { gsl_odeiv2_driver_free(driver); }
  void operator()(gsl_odeiv2_step* step) const { gsl_odeiv2_step_free(step); }
};
template <class T>
using GslOwned = std::unique_ptr<T, GslFree>;

/// While one of these lives GSL returns its errors and does not abort. The handler is global to all threads: the first
/// switches it off, the last puts it back.
class GslErrorsReturned {
 public:
  GslErrorsReturned() {
    std::lock_guard const lock(mutex);
    if (living++ == 0) before = gsl_set_error_handler_off();
  }
  ~GslErrorsReturned() {
    std::lock_guard const lock(mutex);
    if (--living == 0) gsl_set_error_handler(before);
  }
  GslErrorsReturned(GslErrorsReturned const&) = delete;
  GslErrorsReturned& operator=(GslErrorsReturned const&) = delete;

 private:
  inline static std::mutex mutex;
  inline static int living = 0;
  inline static gsl_error_handler_t* before = nullptr;
};

/// A problem as GSL's system: what GSL hands back to our callback stays where it is.
template <Problem P>
class GslSystem {
 public:
  explicit GslSystem(P const& problem) : field_(problem) {}
  GslSystem(GslSystem const&) = delete;
  GslSystem& operator=(GslSystem const&) = delete;

  LibraryField<P> const& field() const { return field_; }
  std::size_t size() const { return std::size_t(field_.size()); }
  gsl_odeiv2_system const* get() const { return &system_; }

 private:
  static int evaluate(double t, double const* y, double* dydt, void* field) {
    (*static_cast<LibraryField<P> const*>(field))(t, y, dydt);
    return GSL_SUCCESS;
  }
  GslErrorsReturned returned_;
  LibraryField<P> field_;
  gsl_odeiv2_system system_{evaluate, nullptr, size(), &field_};
};

/// Steps by gsl_odeiv2_step_apply, for LibraryFixed. It is not asked for the slope at the end, so 13 evaluations make a
/// step; the evolution's own fixed steps take 14.
template <Problem P>
class GslSteps {
 public:
  GslSteps(P const& problem, gsl_odeiv2_step_type const* type)
      : system_(new GslSystem<P>(problem)), y_(system_->size()), error_(system_->size()) {
    stepper_.reset(gsl_odeiv2_step_alloc(type, system_->size()));
    if (!stepper_) throw std::bad_alloc();
  }
  LibraryField<P> const& field() const { return system_->field(); }
  double* numbers() { return y_.data(); }
  void step(double t, double h) {
    gsl_odeiv2_step_apply(stepper_.get(), t, h, y_.data(), error_.data(), nullptr, nullptr, system_->get());
  }
  void restart() { gsl_odeiv2_step_reset(stepper_.get()); }

 private:
  std::unique_ptr<GslSystem<P>> system_;
  GslOwned<gsl_odeiv2_step> stepper_;
  std::vector<double> y_, error_;
};

/// GSL's standard control at its defaults: errors below atol + rtol |y|, 10% more allowed, by component. GSL asks its
/// user for the first step [s]: a method with a history, whose first step is Euler's, gets sqrt(rtol + atol) at every
/// restart; a one-step method .01, and keeps its step size over restarts.
template <Problem P>
class GslAdaptive {
  using M = typename P::Space;

 public:
  GslAdaptive(gsl_odeiv2_step_type const* type, bool has_history, P const& problem, Adaptive control, NormPolicy policy)
      : system_(new GslSystem<P>(problem)),
        y_(system_->size()),
        has_history_(has_history),
        first_step_(has_history ? std::sqrt(control.rtol + control.atol) : 0.01),
        policy_(policy) {
    driver_.reset(gsl_odeiv2_driver_alloc_y_new(system_->get(), type, first_step_, control.atol, control.rtol));
    if (!driver_) throw std::bad_alloc();
  }

  Status advance(Point<M>& x, double t, double t_end) {
    return in_own_steps(
        t, t_end, [&](double& now) { return step(x, now, t_end); }, [&] { return steps_; });
  }
  /// x is read at a restart; between restarts a method with a history goes on from its own.
  Status step(Point<M>& x, double& t, double t_end) {
    gsl_odeiv2_driver& d = *driver_;
    store(x, y_.data());
    int const code = gsl_odeiv2_evolve_apply(d.e, d.c, d.s, system_->get(), &t, t_end, &d.h, y_.data());
    load(x, y_.data());
    if (!all_finite(x)) return Status::diverged;
    if (code != GSL_SUCCESS) return status_of(code);
    ++steps_;
    if (policy_ != NormPolicy::none) {
      projections_.template apply<M>(x, policy_);
      restart();
    }
    return Status::ok;
  }
  void restart() {
    rejected_ += std::int64_t(driver_->e->failed_steps);
    double const h = driver_->h;
    gsl_odeiv2_driver_reset_hstart(driver_.get(), has_history_ ? first_step_ : h);
  }
  /// A new run: the step size is forgotten, too.
  void begin() {
    restart();
    driver_->h = first_step_;
  }
  Work work() const {
    Work work;
    work.steps = steps_;
    work.rejected = rejected_ + std::int64_t(driver_->e->failed_steps);
    return work;
  }
  Projections projections() const { return projections_; }

 private:
  static Status status_of(int code) {
    switch (code) {
      case GSL_EMAXITER:
        return Status::max_steps;
      case GSL_ENOPROG:  // the step is at its least,
      case GSL_FAILURE:  // or no shorter one changes t
        return Status::step_underflow;
      default:
        return Status::diverged;
    }
  }

  std::unique_ptr<GslSystem<P>> system_;
  GslOwned<gsl_odeiv2_driver> driver_;
  std::vector<double> y_;
  bool has_history_;
  double first_step_;
  NormPolicy policy_;
  std::int64_t steps_ = 0, rejected_ = 0;
  Projections projections_;
};
#else
inline constexpr std::string_view gsl_not_built = "not built: configure with POLHODE_GSL=ON (makes the binary GPL)";
#endif

/// Prince & Dormand's pair of 13 stages.
struct GslRk8pd {
  static constexpr MethodInfo info{.name = "gsl_rk8pd",
                                   .family = Family::library,
                                   .order = 8,
                                   .needs = Needs::flat,
                                   .rival = true,
                                   .source = "GSL 2.7, gsl_odeiv2_step_rk8pd; Prince & Dormand (1981)",
                                   .not_built = gsl_not_built};
#ifdef POLHODE_HAS_GSL
  template <LibraryProblem P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return GslAdaptive<P>(gsl_odeiv2_step_rk8pd, false, p, control, policy);
  }
  template <LibraryProblem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return LibraryFixed<GslSteps<P>, P>(p, control, policy, gsl_odeiv2_step_rk8pd);
  }
#endif
};

/// Adams-Moulton methods of orders 1 to 12 in Nordsieck's form, by functional iteration.
struct GslMsadams {
  static constexpr MethodInfo info{
      .name = "gsl_msadams",
      .family = Family::library,
      .needs = Needs::flat,
      .rival = true,
      .source = "GSL 2.7, gsl_odeiv2_step_msadams; Byrne & Hindmarsh (1975), ACM TOMS 1, 71",
      .pitfall = "a multistep history is lost at every sample: each restarts at order 1",
      .no_projection = "projection would break the multistep history that the next step extrapolates",
      .locates_events = false,
      .not_built = gsl_not_built};
#ifdef POLHODE_HAS_GSL
  template <LibraryProblem P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return GslAdaptive<P>(gsl_odeiv2_step_msadams, true, p, control, policy);
  }
#endif
};

}  // namespace polhode
