#pragma once
/// Lists of types, and formulations as their members: what catalogues are made of, and what a problem that does not
/// make sense in every formulation lists as its own `Formulations`.
#include "problems/euler.hpp"
#include "problems/mrp.hpp"
#include "problems/power.hpp"

namespace polhode {

/// A list of types.
template <class... T>
struct Types {
  static constexpr int size = sizeof...(T);
};

namespace detail {
template <class... List>
struct Join;
template <class... T>
struct Join<Types<T...>> {
  using type = Types<T...>;
};
template <class... A, class... B, class... List>
struct Join<Types<A...>, Types<B...>, List...> : Join<Types<A..., B...>, List...> {};
}  // namespace detail
/// Lists of types, one after the other.
template <class... List>
using Joined = typename detail::Join<List...>::type;

/// T is in the list.
template <class T, class... Listed>
constexpr bool is_one_of(Types<Listed...>) {
  return (std::same_as<T, Listed> || ...);
}

/// A formulation: an attitude space, as a type that a list can hold.
template <template <class> class A>
struct Formulation {
  template <class S>
  using On = A<S>;
  static constexpr std::string_view name = A<double>::name;
};

/// Of one rigid body.
using Formulations = Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<SO3>, Formulation<FlatRotation>,
                           Formulation<Mrp>, Formulation<MrpShadow>, Formulation<EulerAngles>>;
/// Those in which methods are raced, unless a problem names its own: typed runs are what the build spends its time on.
using TimedFormulations =
    Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<SO3>, Formulation<FlatRotation>>;
/// Of many rigid bodies.
using BodiesFormulations = Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<SO3>,
                                 Formulation<FlatRotation>, Formulation<Mrp>, Formulation<MrpShadow>>;
/// Of many attitudes.
using AttitudesFormulations = Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<Mrp>>;

}  // namespace polhode
