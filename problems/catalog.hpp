#pragma once
/// Every problem and every formulation. Adding one is a header and a line here; the rest of the project follows.
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"

namespace polhode {

/// A list of types.
template <class... T>
struct Types {
  static constexpr int size = sizeof...(T);
};

/// A formulation: an attitude space, as a type that a list can hold.
template <template <class> class A>
struct Formulation {
  template <class S>
  using On = A<S>;
  static constexpr std::string_view name = A<double>::name;
};

// clang-format off
// One line each: the build makes one translation unit for every line between the brackets.
using Problems = Types<
    FreeBody,
    PdSlew,
    TetherCapture
    >;
// clang-format on

using Formulations =
    Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<SO3>, Formulation<FlatRotation>>;

}  // namespace polhode
