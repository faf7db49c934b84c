#pragma once
/// Every problem and every formulation. Adding one is a header and a line here; the rest of the project follows.
#include "problems/formulations.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"

namespace polhode {

// clang-format off
// One line each: the build makes one translation unit for every line between the brackets.
using Problems = Types<
    FreeBody,
    PdSlew,
    TetherCapture
    >;
// clang-format on

using Formulations = Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<SO3>, Formulation<FlatRotation>>;

}  // namespace polhode
