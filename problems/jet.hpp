#pragma once
/// Truncated power series in time. Evaluating a problem on jets gives the Taylor coefficients of its solution:
/// x_{k+1} = f(x)_k / (k + 1).
/// Sources: Jorba & Zou (2005), Experimental Mathematics 14, sec. 2; Griewank & Walther (2008), Evaluating
/// Derivatives, ch. 13 (the recurrences)
#include <array>
#include <vector>

#include "problems/scalar.hpp"

namespace polhode {

/// A series with coefficients R. One of degree 0 is a constant; an operation has the higher degree of its operands,
/// never above `most`.
template <class R, int most>
struct Jet {
  std::array<R, most + 1> c{};  ///< coefficients of 1, t, t^2, ..., c[degree]
  int degree = 0;

  Jet() = default;
  Jet(R const& constant) { c[0] = constant; }
  Jet(double constant) requires(!std::same_as<R, double>) { c[0] = R(constant); }

  R const& operator[](int k) const { return c[std::size_t(k)]; }
  R& operator[](int k) { return c[std::size_t(k)]; }

  /// The value at time t after the centre.
  R at(R const& t) const {
    R sum = c[std::size_t(degree)];
    for (int k = degree - 1; k >= 0; --k) sum = sum * t + (*this)[k];
    return sum;
  }
  /// coefficient(k) for k = 0 .. degree, in order.
  template <class F>
  static Jet of(int degree, F coefficient) {
    Jet r;
    r.degree = degree;
    for (int k = 0; k <= degree; ++k) r[k] = coefficient(k);
    return r;
  }

  friend Jet operator+(Jet const& x, Jet const& y) {
    return of(std::max(x.degree, y.degree), [&](int k) { return x[k] + y[k]; });
  }
  friend Jet operator-(Jet const& x, Jet const& y) {
    return of(std::max(x.degree, y.degree), [&](int k) { return x[k] - y[k]; });
  }
  friend Jet operator-(Jet const& x) {
    return of(x.degree, [&](int k) { return -x[k]; });
  }
  friend Jet operator*(R const& a, Jet const& x) {
    return of(x.degree, [&](int k) { return a * x[k]; });
  }
  friend Jet operator*(Jet const& x, Jet const& y) {
    if (x.degree == 0) return x[0] * y;
    if (y.degree == 0) return y[0] * x;
    return grown(std::max(x.degree, y.degree), [&](Jet const&, int k) {
      R sum = x[0] * y[k];
      for (int j = 1; j <= k; ++j) sum += x[j] * y[k - j];
      return sum;
    });
  }
  friend Jet operator/(Jet const& x, Jet const& y) {
    return grown(std::max(x.degree, y.degree), [&](Jet const& q, int k) {
      R sum = x[k];
      for (int j = 1; j <= k; ++j) sum = sum - y[j] * q[k - j];
      return R(sum / y[0]);
    });
  }
  Jet& operator+=(Jet const& y) { return *this = *this + y; }
  friend bool operator<(Jet const& x, Jet const& y) { return x[0] < y[0]; }
  friend bool operator==(Jet const& x, Jet const& y) { return x[0] == y[0]; }
  friend bool is_nothing(Jet const& x) { return x.degree == 0 && x[0] == R(0.0); }

  friend Jet sqrt(Jet const& x) {
    return grown(x.degree, [&](Jet const& r, int k) {
      if (k == 0) return R(sqrt(x[0]));
      R sum = x[k];
      for (int j = 1; j < k; ++j) sum = sum - r[j] * r[k - j];
      return R(sum / (R(2.0) * r[0]));
    });
  }
  friend Jet sin(Jet const& x) { return sin_and_cos(x).first; }
  friend Jet cos(Jet const& x) { return sin_and_cos(x).second; }
  /// theta' (x^2 + y^2) = x y' - y x'.
  friend Jet atan2(Jet const& y, Jet const& x) {
    Jet const square = x * x + y * y;
    return grown(std::max(x.degree, y.degree), [&](Jet const& theta, int k) {
      if (k == 0) return R(atan2(y[0], x[0]));
      R sum(0.0);
      for (int j = 1; j <= k; ++j) sum += R(double(j)) * (x[k - j] * y[j] - y[k - j] * x[j]);
      for (int j = 1; j < k; ++j) sum = sum - R(double(j)) * theta[j] * square[k - j];
      return R(sum / (R(double(k)) * square[0]));
    });
  }

  /// What the products, quotients and roots of one evaluation were. The next evaluation of the same expressions on jets
  /// that agree with those but are longer goes on from there: n coefficients then cost n^2, not n^3.
  class Memory {
   public:
    /// Jets of this thread remember from now on, until the end of this object; only one at a time.
    Memory() { current = this; }
    ~Memory() {
      if (current == this) current = nullptr;
    }
    Memory(Memory const&) = delete;
    Memory& operator=(Memory const&) = delete;
    /// The same expressions follow once more.
    void rewind() { next_ = 0; }
    /// Jets remember no longer, until resume(), which forgets what was but keeps the room.
    void pause() { current = nullptr; }
    void resume() {
      current = this;
      next_ = 0;
      for (Jet& result : results_) result.degree = -1;
    }

   private:
    friend Jet;
    template <class F>
    Jet continued(int degree, F const& coefficient) {
      if (next_ == results_.size()) results_.emplace_back().degree = -1;
      Jet& r = results_[next_++];
      // A branch may have been taken the other way: what follows is another expression.
      if (r.degree > degree || (r.degree >= 0 && !(r[0] == coefficient(r, 0)))) r.degree = -1;
      for (int k = r.degree + 1; k <= degree; ++k) r[k] = coefficient(r, k);
      r.degree = degree;
      return r;
    }
    std::vector<Jet> results_;
    std::size_t next_ = 0;
  };

 private:
  inline static thread_local Memory* current = nullptr;

  /// coefficient(r, k) for k = 0 .. degree, from those of r that are there already.
  template <class F>
  static Jet grown(int degree, F const& coefficient) {
    if (current) return current->continued(degree, coefficient);
    Jet r;
    r.degree = degree;
    for (int k = 0; k <= degree; ++k) r[k] = coefficient(r, k);
    return r;
  }

  friend std::pair<Jet, Jet> sin_and_cos(Jet const& x) {
    Jet s, c;
    s.degree = c.degree = x.degree;
    s[0] = sin(x[0]);
    c[0] = cos(x[0]);
    for (int k = 1; k <= x.degree; ++k) {
      R ds(0.0), dc(0.0);
      for (int j = 1; j <= k; ++j) {
        ds += R(double(j)) * x[j] * c[k - j];
        dc += R(double(j)) * x[j] * s[k - j];
      }
      s[k] = ds / R(double(k));
      c[k] = -dc / R(double(k));
    }
    return {s, c};
  }
};
template <class R, int most>
struct ScalarTraits<Jet<R, most>> {
  using Real = R;
  static constexpr bool short_series = false;
  static constexpr bool flattened = false;
};

}  // namespace polhode
