#pragma once
/// Lists of types, and formulations as their members: what catalogues are made of, and what a problem that does not
/// make sense in every formulation lists as its own `Formulations`.
#include "problems/space.hpp"

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

}  // namespace polhode
