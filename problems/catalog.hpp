#pragma once
/// Every problem. Adding one is a header and a line here; the rest of the project follows. (Formulations:
/// formulations.hpp.)
#include "problems/dead_zone.hpp"
#include "problems/formulations.hpp"
#include "problems/free_body.hpp"
#include "problems/gravity_gradient.hpp"
#include "problems/group_consensus.hpp"
#include "problems/heavy_top.hpp"
#include "problems/krogh_b5.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "problems/so3_cooperative.hpp"
#include "problems/tether_capture.hpp"

namespace polhode {

// clang-format off
// One line each: the build makes one translation unit for every line between the brackets.
using Problems = Types<
    FreeBody,
    PdSlew,
    HeavyTop,
    GravityGradient,
    KroghB5,
    TetherCapture,
    DeadZone,
    QuaternionSync,
    GroupConsensus,
    So3Cooperative
    >;
// clang-format on

}  // namespace polhode
