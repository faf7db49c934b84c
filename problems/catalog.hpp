#pragma once
/// Every problem and every formulation. Adding one is a header and a line here; the rest of the project follows.
#include "problems/dead_zone.hpp"
#include "problems/euler.hpp"
#include "problems/formulations.hpp"
#include "problems/free_body.hpp"
#include "problems/group_consensus.hpp"
#include "problems/mrp.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "problems/tether_capture.hpp"

namespace polhode {

// clang-format off
// One line each: the build makes one translation unit for every line between the brackets.
using Problems = Types<
    FreeBody,
    PdSlew,
    TetherCapture,
    DeadZone,
    QuaternionSync,
    GroupConsensus
    >;
// clang-format on

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
