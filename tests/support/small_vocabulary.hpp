#pragma once
/// A vocabulary of three problems and four integrators, small enough that tests can spell out every message.
#include <string>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench::test {

inline IntegratorWord integrator_word(std::string const& name, bool fixed, bool adaptive) {
  IntegratorWord word;
  word.name = name;
  word.fixed = fixed;
  word.adaptive = adaptive;
  return word;
}

inline Vocabulary small_vocabulary() {
  ProblemWord tether;
  tether.name = "tether_capture";
  tether.variants = {
      {"case1", "case2", "case3", "free"}, {"g1", "g2"}, {"", "as_printed"}, {"", "raw_q0"}, {"", "coupled"}};
  tether.formulations = {"quaternion", "s3", "mrp"};
  tether.parameters = {{"inertia", "kg m^2", {1, 2, 2.5}}, {"sample_period", "s", {0.1}}};

  ProblemWord body;
  body.name = "free_body";
  body.formulations = {"quaternion", "s3"};
  body.parameters = {{"inertia", "kg m^2", {0.6, 0.8, 1.0}}, {"omega0", "rad/s", {1, 0, 0}}};

  ProblemWord slew;
  slew.name = "pd_slew";
  slew.variants = {{"plain", "gyrostat"}};
  slew.formulations = {"quaternion"};
  slew.parameters = {{"k_p", "1/s^2", {1}}};

  Vocabulary vocabulary;
  vocabulary.problems = {tether, body, slew};
  vocabulary.integrators = {integrator_word("rk4", true, false), integrator_word("dopri5", true, true),
                            integrator_word("gauss2", true, false), integrator_word("cvode_bdf", false, true)};
  vocabulary.integrators.back().not_built = "built without SUNDIALS";
  vocabulary.policies = {"none", "project"};
  return vocabulary;
}

}  // namespace polhode::bench::test
