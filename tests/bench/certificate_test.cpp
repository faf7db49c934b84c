/// What a reference's certificate says: where there is a closed form, it is a witness.
#include <gtest/gtest.h>

#include "bench/cell/cell.hpp"
#include "bench/cell/reference.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

bench::Certificate certificate_of(test::CellUnderTest const& it) {
  bench::PreparedCell const prepared = bench::prepare(it.with_rtol(1e-6).until(5).cell);
  return bench::certify(prepared.physics, *prepared.problem, prepared.schedule,
                        bench::Reference::solve(*prepared.problem, prepared.schedule));
}

TEST(Certificate, HoldsAFreeBodyAgainstTheClosedForm) {
  for (auto const& it : {test::a_cell("free_body", "quaternion", "dopri5"),
                         test::a_cell("tether_capture", "quaternion", "dopri5").of_variant("free")}) {
    bench::Certificate const certificate = certificate_of(it);
    ASSERT_TRUE(certificate.closed_form.has_value()) << certificate.subject;
    EXPECT_LT(*certificate.closed_form, 1e-31) << certificate.subject;
    EXPECT_GE(certificate.bar, *certificate.closed_form) << certificate.subject;
  }
}

TEST(Certificate, KnowsNoClosedFormOfOtherProblems) {
  auto const free_body = test::a_cell("free_body", "quaternion", "dopri5");
  auto const tether = test::a_cell("tether_capture", "quaternion", "dopri5");
  for (auto const& it :
       {free_body.set("inertia", {100, 120, 110, 1, 2, 3}), tether, tether.of_variant("free,as_printed"),
        tether.of_variant("free,raw_q0"), test::a_cell("pd_slew", "quaternion", "dopri5")})
    EXPECT_FALSE(certificate_of(it).closed_form.has_value()) << it.cell.problem << " " << it.cell.variant;
}

}  // namespace
}  // namespace polhode
