#pragma once
/// A record that nothing ran for: of the free body on flat quaternions, ended ok.
#include <string>

#include "results/record.hpp"

namespace polhode::test {

inline results::Record made_up_record(std::string const& integrator, double h, std::string const& build) {
  results::Record record;
  record.of.problem = "free_body";
  record.of.formulation = "quaternion";
  record.of.integrator = integrator;
  record.of.h = h;
  record.of.t_end = 50;
  record.cell = results::cell_id(record.of);
  record.build = build;
  record.steps = 500;
  return record;
}

}  // namespace polhode::test
