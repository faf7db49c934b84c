#include "report/papers.hpp"

namespace polhode::report {

Paper const& so3_cooperative() {
  using enum Source;
  static Paper const paper{
      .problem = "so3_cooperative",
      .title = "Five craft come to one attitude on SO(3)",
      .citation =
          "Ma, Dong, Ma & Wang (2018), \"SO(3)-based cooperative attitude control of multiple spacecraft\", Journal of "
          "Astronautics 39(6), 664, doi 10.3873/j.issn.1000-1328.2018.06.009",
      .about =
          "Each spacecraft follows the mean attitude of those that it hears, by a sliding-mode torque: on rotation "
          "matrices (method 1, the paper's), on quaternions (2) and on Rodrigues parameters (3), which it compares "
          "with.",
      .cases = {"method1", "method2", "method3"},
      .unsaid = {},
      .apart = {"unlocated"},
      .data = {{"graph", "a14 .58, a23 .33, a25 .11, a32 .25, a41 .21, a43 .40, a51 .37", printed,
                "craft i hears craft j"},
               {"gains of method 1", "K1 1.15, K2 .15 1/s, P1 = P2 = .03", printed, ""},
               {"power in the laws", "|s|^(1/2) sgn s", printed, ""},
               {"times t1", "4.89, 5.15, 9.29 s for methods 1, 2, 3", printed,
                "the initial data they belong to are lost in the text at hand"},
               {"strong connection", "1-5-2-3-4-1", deduced, "from the links"},
               {"cross term in the torque", "X", deduced,
                "with it the linear loop is s^2 + 1.3 s + 1.1725, at rest after 10 s as in the figures"},
               {"part of the inertia", "none in the motion", deduced, "it cancels; torques alone depend on it"},
               {"order of the angles in q_a", "pitch, yaw, roll about z, y, x", deduced, ""},
               {"weights", "rows of the graph sum to 1", chosen, ""},
               {"command", "two axes, averaged and made orthogonal", chosen,
                "cross products and normalisation are named, equations are lost"},
               {"feed-forward rho", ".8 of the command's rate", chosen, "at 1 the accelerations have no solution"},
               {"smoothing delta of the power", ".1 for orders, .01 for times", chosen, "0 is the printed power"},
               {"surfaces of method 1", "far: the logarithm; near: within 20 deg (switching)", chosen,
                "the near one is singular at 90 and 180 deg"},
               {"methods 2 and 3", "after the works it compares with", chosen, ""},
               {"their gains", "set_e: equal linearisation; set_p: the printed order of t1", chosen, ""},
               {"initial data and inertia", "ex1: angles up to 45 deg, at rest; ex2: large angles", chosen, ""},
               {"norm in q_a", "root mean square over the five", chosen, ""}},
      .statements = {{"", "t1", "q_a stays below 1 deg from", "s", 1},
                     {"", "t1_ours", "the same, against our own to many digits", "s", 1},
                     {"", "q_a_5s", "q_a at 5 s, against our own", "deg", 1}},
      .errata = {}};
  return paper;
}

}  // namespace polhode::report
