#pragma once
/// The catalogue's lists by name alone: what the harness needs to know without compiling every method.
#include "problems/formulations.hpp"

namespace polhode {

struct ExplicitMethods;
struct GaussMethods;
struct GroupMethods;
struct BodyMethods;
struct Rivals;
/// In the order of the catalogue. The build compiles each in a unit of its own.
using MethodLists = Types<ExplicitMethods, GaussMethods, GroupMethods, BodyMethods, Rivals>;
/// Those of our own that are raced: see races.hpp.
struct RacedMethods;
/// The lists whose methods are raced.
using RaceLists = Types<RacedMethods, Rivals>;

}  // namespace polhode
