#include "report/papers.hpp"

#include "report/text.hpp"

namespace polhode::report {

using enum Source;

std::string_view name_of(Source source) {
  switch (source) {
    case printed:
      return "printed";
    case deduced:
      return "deduced";
    case chosen:
      return "chosen";
  }
  return "";
}

Paper const& tether_capture() {
  constexpr std::string_view at_target = "points at the target by 50 s (below 1 deg)";
  static double const degree = degrees(1);
  static Paper const paper{
      .problem = "tether_capture",
      .title = "The three control strategies",
      .citation =
          "Xu, Wang, Deng, Li & Wei (2017), \"Attitude control of targets captured by tethered space robots based on "
          "the quaternion theory\", Applied Mathematics and Mechanics 38(12), 1309, doi 10.21656/1000-0887.380168",
      .about =
          "A tethered robot has caught a tumbling target and brings it to rest with the grapple arm along the tether, "
          "by its tension, by thrusters, or by both.",
      .cases = {"case1", "case2", "case3"},
      .unsaid = {},
      .apart = {"coupled"},
      .data = {{"inertia", "diag(100, 120, 110) kg m^2", printed, ""},
               {"initial rate", "10 deg/s about each axis", printed, ""},
               {"initial attitude", "(.227, .383, .227, .866), scalar last", printed,
                "|q|^2 - 1 = -2.97e-4, so it is normalised; raw_q0 leaves it"},
               {"tether, limit of thrust, switching angle", "(-200, 0, 0) m, 5 N m, 5 deg", printed, ""},
               {"control laws, horizon", "eqs. (17) to (25), 50 s", printed, ""},
               {"arm", "(-2, 0, 0) m in body axes", deduced,
                "its length is printed; no torque about x, greatest angle"},
               {"sign of the gyroscopic term", "minus", deduced, "Euler's equation; as_printed has the printed plus"},
               {"gains", "g1 strong tether, g2 weak tether", deduced, "search for what reproduces the figures"},
               {"sample period", "0.1 s, torque held", chosen, "no number is printed"}},
      .statements = {{"case1", "alpha_max", "the angle grows slightly at first", "deg", degree},
                     {"case1", "alpha_maxima", "then falls: one maximum at most", "", 1},
                     {"case1", "alpha_end", at_target, "deg", degree},
                     {"case1", "energy_c", "thruster effort E1", "N^2 m^2 s", 1},
                     {"case2", "alpha_max", "greatest angle", "deg", degree},
                     {"case2", "alpha_maxima", "the angle falls in waves: two maxima or more", "", 1},
                     {"case2", "alpha_end", at_target, "deg", degree},
                     {"case2", "energy_c", "thruster effort E2", "N^2 m^2 s", 1},
                     {"case3", "alpha_max", "the angle rises to", "deg", degree},
                     {"case3", "alpha_maxima", "then falls: one maximum at most", "", 1},
                     {"case3", "omega_y_zero", "omega_y is zero near", "s", 1},
                     {"case3", "alpha_end", at_target, "deg", degree},
                     {"case3", "energy_c", "thruster effort E3", "N^2 m^2 s", 1}},
      .errata = {{"eq. (3)", "J omega' = + omega x J omega + ...", "- omega x J omega; see the sign erratum"}}};
  return paper;
}

Paper const& quaternion_sync() {
  static Paper const paper{
      .problem = "quaternion_sync",
      .title = "Spacecraft that synchronise their quaternions",
      .citation =
          "Meng, San & Zhang (2022), \"Global attitude synchronization for networked spacecraft with quaternion-based "
          "representations\", Journal of Henan Normal University (Natural Science) 50(6), 1, "
          "doi 10.16366/j.cnki.1000-2367.2022.06.001",
      .about =
          "Five spacecraft command their body rates from the quaternions of those that they hear: protocol (7) as they "
          "are, protocol (13) with the signs of the scalar parts taken out.",
      .cases = {"protocol7", "protocol13"},
      .unsaid = {},
      .apart = {"unlocated"},
      .data = {{"graph", "a12, a15, a23, a24, a34, a41, a54 = 1", printed, "strongly connected"},
               {"vector parts", "five", printed, ""},
               {"scalar parts", ".6846, .2194, .2798, .4103, .0939", printed,
                "for (13) those of craft 1, 3 and 5 are negative"},
               {"norms", "|q|^2 - 1 = +.1711, -.0292, -.0128, -.0097, -.0053", deduced,
                "normalized divides by the norm, recomputed keeps the vector part, raw keeps all"},
               {"step and horizon", "0.1 s, 20 s", printed, "the steps of the tables below are ours"},
               {"weights in V", "(2, 1, 1, 4, 2)/10", deduced, "left null vector of the Laplacian"},
               {"trap", "(.3, -.4, .5) five times, scalar parts +, +, -, +, - times the root of 1/2", chosen,
                "an equilibrium of (7) in which attitudes differ"},
               {"large networks", "ring and random links, random attitudes", chosen, "seeded"}},
      .statements = {{"", "lemma_1", "the least scalar part never decreases: its greatest fall", "", 1},
                     {"", "lyapunov_rise", "V never increases: its greatest rise", "", 1},
                     {"", "lyapunov_start", "V at the start", "", 1},
                     {"", "lyapunov_end", "V at 20 s", "", 1},
                     {"", "together", "quaternions stay within 1e-2 of each other from", "s", 1},
                     {"", "disagreement_end", "largest |q_i - q_j| at 20 s", "", 1},
                     {"", "scalar_consensus",
                      "scalar parts agree at 20 s, within 1e-3 (its figures 1, 2): they differ by", "", 1},
                     {"", "trap", "(7) stays in the trap: greatest departure from a distance of the root of 2", "", 1},
                     {"protocol13", "crossing_1", "craft 5's scalar part reaches 0 at", "s", 1},
                     {"protocol13", "crossing_2", "craft 3's at", "s", 1},
                     {"protocol13", "crossing_3", "craft 1's at", "s", 1}},
      .errata = {{"initial data", "attitude quaternions", "not of length one; their scalar parts cannot agree"}}};
  return paper;
}

Paper const& group_consensus() {
  static Paper const paper{
      .problem = "group_consensus",
      .title = "A swarm in two groups",
      .citation =
          "Zhou, Wang, Liu, Zhao, Qi & Yan (2020), \"Cooperative attitude control in rigid body swarms based on group "
          "consensus\", Scientia Sinica Technologica 50(5)",
      .about =
          "Five rigid bodies in groups of three and two are pulled to a common motion within each group, by torques "
          "that see modified Rodrigues parameters and rates of neighbours.",
      .cases = {"ic1", "ic2", "ic3"},
      .unsaid = {},
      .apart = {"unlocated", "theorem2"},
      .data = {{"links within the groups", "1-2, 1-3, 2-3, 4-5: +1", printed, ""},
               {"links between them", "1-4, 2-5: +1; 1-5, 2-4: -1", deduced,
                "in-degree balance up to one sign, which the printed results give"},
               {"inertia", "1 kg m^2 about each axis", deduced, "a steady rate in a general direction needs it"},
               {"initial sigma and omega, magnitudes", "fifteen each", printed, "ic2: sigma = 0; ic3: omega = 0"},
               {"their signs", "lost in the text at hand", deduced,
                "search for what gives the printed rates; all y and z signs together stay open"},
               {"horizon", "100 s", printed, "ours: 200 s"},
               {"theorem2", "sigma = 0, all rates (.1, .2, .2) rad/s", chosen, "its counterexample"}},
      .statements = {{"ic1", "zero_eigenvalues", "the Laplacian has two eigenvalues 0", "", 1, true},
                     {"ic1", "least_eigenvalue", "theorem 1: no eigenvalue is negative; the least", "", 1, true},
                     {"ic1", "greatest_eigenvalue", "theorem 1: none above twice the largest in-degree; the greatest",
                      "", 1, true},
                     {"", "lyapunov_start", "V at the start", "J", 1},
                     {"", "lyapunov_rise", "V never increases: its greatest rise", "J", 1},
                     {"", "together", "rates within each group stay within .1 from", "s", 1},
                     {"", "g1_x", "steady rate of bodies 1 to 3, |x|", "rad/s", 1},
                     {"", "g1_y", "|y|", "rad/s", 1},
                     {"", "g1_z", "|z|", "rad/s", 1},
                     {"", "g2_x", "steady rate of bodies 4 and 5, |x|", "rad/s", 1},
                     {"", "g2_y", "|y|", "rad/s", 1},
                     {"", "g2_z", "|z|", "rad/s", 1}},
      .errata = {
          {"steady rates of ic1", "two decimals", "an artefact of a loose tolerance, see below"},
          {"theorem 1", "no eigenvalue exceeds twice the largest in-degree", "its own matrix does, see below"},
          {"theorem 1", "no eigenvalue is negative",
           "not of every balanced graph: links +1 on 1-2, 2-3, 4-5, 1-4, 3-5 and -1 on 1-5, 3-4 have "
           "(3 - root 17)/2"},
          {"theorem 2", "group consensus", "bodies that agree feel no torque, and sigma may escape, see below"}}};
  return paper;
}

Paper const& dead_zone() {
  static Paper const paper{
      .problem = "dead_zone",
      .title = "Actuators with a dead zone",
      .citation =
          "Li, Chen, Chen & Zhang (2018), \"Finite-time attitude control of spacecrafts with input dead-zone "
          "nonlinearities\", Journal of Harbin Institute of Technology 50(4), 21, "
          "doi 10.11918/j.issn.0367-6234.201704116",
      .about =
          "A spacecraft follows a path that comes to rest at a chosen time t_f, by a sliding law with a boundary "
          "layer, through actuators that do nothing around zero and have jumps at the ends of that gap.",
      .cases = {"printed", "continuous", "smooth"},
      .unsaid = {"cubic", "n2"},
      .apart = {"unlocated"},
      .data = {{"inertia", "(950, 600, 360; xy 11, xz 5, yz 36) kg m^2", printed, ""},
               {"disturbance", "sines of .1, .2 and .3 N m", printed, ""},
               {"initial data", "sigma (-.128, .515, .128), omega (.1, -.3, .2) rad/s", printed, ""},
               {"t_f", "50 and 80 s", printed, ""},
               {"actuators", "slopes .95, 1, 1.05; wavy departures; breakpoints -.6 .. .6 N m", printed,
                "variants: continuous has no jumps at the breakpoints, smooth has no dead zone"},
               {"path", "cubic polynomial to rest", deduced, "from its end conditions; quintic has no jump at t_f"},
               {"error of the inertia", "p = -.2, 0, .2", deduced, "read as a factor 1 + p of the whole matrix"},
               {"gain k", "5e-3 1/s^2", chosen, "the printed rule needs 3.34e-3 with the inertia off by 20%"},
               {"c and beta", "n2: 100 1/s, 5e-5; n1, n3, n4: slower", chosen, "not printed"},
               {"horizon", "50 s past t_f", chosen, ""}},
      .statements = {},
      .errata = {{"eqs. (6) and (19)", "no dots", "time derivatives"},
                 {"sliding law", "|s_i| >= sigma_i", "|s_i| >= beta_i"},
                 {"six numbers named delta", "delta", "the breakpoints b"},
                 {"G(sigma)", "symmetric and positive definite",
                  "not symmetric; its symmetric part is positive definite for |sigma| < 1 alone"},
                 {"departures of the actuators", "|delta| < .2", "the bound is attained"},
                 {"condition 1", "a smooth path", "the cubic's second derivative jumps at t_f"}}};
  return paper;
}

}  // namespace polhode::report
