/// Random numbers of ensembles: the generator against its authors' answers, distributions against their laws.
#include "bench/ensemble/dispersion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/ensemble/philox.hpp"

namespace polhode::bench {
namespace {

TEST(Philox, GivesTheKnownAnswers) {
  struct Known {
    std::array<std::uint32_t, 4> counter;
    std::array<std::uint32_t, 2> key;
    std::array<std::uint32_t, 4> answer;
  };
  constexpr std::uint32_t ones = 0xFFFFFFFF;
  // Random123, tests/kat_vectors, lines "philox4x32 10".
  for (auto const& [counter, key, answer] :
       {Known{{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        Known{{ones, ones, ones, ones}, {ones, ones}, {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        Known{{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
              {0xa4093822, 0x299f31d0},
              {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}})
    EXPECT_EQ(philox4x32(counter, key), answer);
}
TEST(Philox, NumbersStayInsideTheOpenInterval) {
  EXPECT_GT(open_unit(0, 0), 0);
  EXPECT_LT(open_unit(0xFFFFFFFF, 0xFFFFFFFF), 1);
}

ProblemWord const& body() {
  static ProblemWord const word{.name = "some_body",
                                .summary = {},
                                .source = {},
                                .variants = {},
                                .formulations = {},
                                .parameters = {{"inertia", "kg m^2", {100, 120, 110}},
                                               {"q0", "", {0, 0, 0, 1}},
                                               {"omega0", "rad/s", {1, 2, 3}},
                                               {"k_p", "N m", {4}},
                                               {"sample_period", "s", {0.1}},
                                               {"graph", "", {1, 2, 1}}},
                                .events = {},
                                .claims = {}};
  return word;
}
Dispersions read(std::vector<std::string> const& texts, std::uint64_t seed = 1,
                 std::map<std::string, std::vector<double>> const& set = {}) {
  return Dispersions(body(), set, texts, seed);
}

struct Moments {
  double mean = 0, deviation = 0, least = 1e300, most = -1e300;
};
template <class F>
Moments moments_of(int count, F f) {
  Moments m;
  double squares = 0;
  for (int k = 0; k < count; ++k) {
    double const x = f(k);
    m.mean += x / count;
    squares += x * x / count;
    m.least = std::min(m.least, x);
    m.most = std::max(m.most, x);
  }
  m.deviation = std::sqrt(squares - m.mean * m.mean);
  return m;
}
constexpr int many = 100'000;

TEST(Dispersion, NumbersFollowTheirLaws) {
  // 5 standard errors of a mean, of a standard deviation: a seed that fails is one in a million.
  double const of_mean = 5 / std::sqrt(double(many)), of_deviation = 5 / std::sqrt(2.0 * many);
  auto const drawn = [](std::string const& law) {
    Dispersions const d = read({"k_p=" + law});
    return moments_of(many, [&](int k) { return d.with_sample({}, k).at("k_p")[0]; });
  };
  Moments const normal = drawn("normal(10,2)");
  EXPECT_NEAR(normal.mean, 10, 2 * of_mean);
  EXPECT_NEAR(normal.deviation, 2, 2 * of_deviation);
  Moments const uniform = drawn("uniform(-1,3)");
  EXPECT_NEAR(uniform.mean, 1, 4 / std::sqrt(12.0) * of_mean);
  EXPECT_NEAR(uniform.deviation, 4 / std::sqrt(12.0), 4 / std::sqrt(12.0) * of_deviation);
  EXPECT_GE(uniform.least, -1);
  EXPECT_LE(uniform.most, 3);
  Dispersions const d = read({"k_p=log_uniform(1e-3,10)"});
  Moments const logarithm = moments_of(many, [&](int k) { return std::log10(d.with_sample({}, k).at("k_p")[0]); });
  EXPECT_NEAR(logarithm.mean, -1, 4 / std::sqrt(12.0) * of_mean);
  EXPECT_GE(logarithm.least, -3);
  EXPECT_LE(logarithm.most, 1);
}

/// Haar's measure: each component squared has mean 1/4, the fourth power 1/8; the cosine of the angle between a turned
/// axis and itself is uniform.
TEST(Dispersion, AttitudesAreUniformOnTheRotationGroup) {
  Dispersions const d = read({"q0=so3()"});
  for (std::size_t i = 0; i < 4; ++i) {
    auto const component = [&](int k) { return d.with_sample({}, k).at("q0")[i]; };
    EXPECT_NEAR(moments_of(many, component).mean, 0, 5 * 0.5 / std::sqrt(double(many)));
    Moments const squares = moments_of(many, [&](int k) { return component(k) * component(k); });
    EXPECT_NEAR(squares.mean, 0.25, 5 * 0.25 / std::sqrt(double(many)));
    EXPECT_NEAR(squares.deviation, 0.25, 5 * 0.25 / std::sqrt(double(many)));
  }
  Moments const cosine = moments_of(many, [&](int k) {
    auto const q = d.with_sample({}, k).at("q0");
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-15);
    return 1 - 2 * (q[0] * q[0] + q[1] * q[1]);
  });
  EXPECT_NEAR(cosine.mean, 0, 5 / std::sqrt(3.0 * many));
  EXPECT_NEAR(cosine.deviation, 1 / std::sqrt(3.0), 0.005);
}

TEST(Dispersion, ASampleDependsOnSeedAndSampleAlone) {
  auto const alone = read({"omega0.y=normal(0,1)"}), beside = read({"k_p=uniform(1,2)", "omega0.y=normal(0,1)"});
  auto const other = read({"omega0.y=normal(0,1)"}, 2);
  for (std::int64_t const k : {std::int64_t{0}, std::int64_t{1}, std::int64_t{1} << 40}) {
    EXPECT_EQ(alone.with_sample({}, k).at("omega0"), beside.with_sample({}, k).at("omega0"));
    EXPECT_NE(alone.with_sample({}, k).at("omega0"), other.with_sample({}, k).at("omega0"));
  }
  EXPECT_NE(alone.with_sample({}, 0), alone.with_sample({}, 1));
  EXPECT_NE(alone.with_sample({}, 0), alone.with_sample({}, std::int64_t{1} << 32));
}
TEST(Dispersion, ComponentsAreIndependentAndOthersStay) {
  auto const all = read({"omega0=normal(0,1)"}).with_sample({}, 7).at("omega0");
  EXPECT_NE(all[0], all[1]);
  EXPECT_NE(all[1], all[2]);
  auto const one = read({"omega0.y=normal(0,1)"}).with_sample({}, 7).at("omega0");
  EXPECT_EQ(one, (std::vector<double>{1, all[1], 3}));
  EXPECT_EQ(read({"omega0.2=normal(0,1)"}).list()[0].text, "omega0.y=normal(0,1)");
  auto const set = read({"omega0.y=normal(0,1)"}, 1, {{"omega0", {5, 6, 7}}}).with_sample({}, 7).at("omega0");
  EXPECT_EQ(set, (std::vector<double>{5, all[1], 7}));
}

TEST(Dispersion, NonsenseIsRefusedInALineThatSaysWhatWouldBeRight) {
  for (auto const& [text, right] :
       std::vector<std::pair<std::string, std::string>>{{"omega0", "NAME=DISTRIBUTION"},
                                                        {"omgea0=normal(0,1)", "did you mean 'omega0'"},
                                                        {"omega0.u=normal(0,1)", "choose from x, y, z"},
                                                        {"k_p.x=normal(0,1)", "write k_p="},
                                                        {"k_p=gauss(0,1)", "normal(MEAN,SIGMA)"},
                                                        {"k_p=unifrom(0,1)", "uniform(A,B)"},
                                                        {"k_p=normal", "write normal(MEAN,SIGMA)"},
                                                        {"k_p=normal(1)", "takes 2 numbers, not 1"},
                                                        {"k_p=normal(1,2,3)", "takes 2 numbers, not 3"},
                                                        {"k_p=normal(1,x)", "'x' is not a finite number"},
                                                        {"k_p=normal(1,0)", "greater than 0"},
                                                        {"k_p=uniform(2,1)", "lower end first"},
                                                        {"k_p=log_uniform(0,1)", "0 < A < B"},
                                                        {"omega0=so3()", "q0=so3()"},
                                                        {"q0=normal(0,1)", "q0=so3()"},
                                                        {"q0.x=so3()", "q0=so3()"},
                                                        {"sample_period=uniform(0.1,0.2)", "--set"},
                                                        {"graph=uniform(1,2)", "--set"}}) {
    try {
      read({text});
      ADD_FAILURE() << text << " is taken";
    } catch (UsageError const& error) {
      EXPECT_NE(std::string(error.what()).find(right), std::string::npos) << text << ": " << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_THROW(read({"omega0=normal(0,1)", "omega0.x=normal(0,1)"}), UsageError);
  EXPECT_THROW(read({"omega0=normal(0,1)"}, 1, {{"omega0", {1, 2, 3}}}), UsageError);
}

}  // namespace
}  // namespace polhode::bench
