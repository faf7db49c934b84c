#pragma once
/// Every problem. Adding one is a header and a line here; the rest of the project follows. (Formulations:
/// formulations.hpp.)
#include "problems/coning.hpp"
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
// One line each: the build makes one translation unit for every line between the brackets, and includes the header of
// that name.
/// Methods are raced on these: compiled with them as typed code, as a user's own program would be.
using RacedProblems = Types<
    FreeBody,
    PdSlew,
    TetherCapture,
    QuaternionSync
    >;
/// On these they are timed through virtual calls, our own as rivals.
using OtherProblems = Types<
    HeavyTop,
    GravityGradient,
    KroghB5,
    Coning,
    DeadZone,
    GroupConsensus,
    So3Cooperative
    >;
// clang-format on
using Problems = Joined<RacedProblems, OtherProblems>;

}  // namespace polhode
