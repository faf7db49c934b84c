// The report's sections, from made-up records: each says what its question is about, or what it lacks.
#include <iterator>

#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

namespace fs = std::filesystem;
using namespace samples;

/// The sentences of the answer, which stand between the question and the first figure or table.
std::vector<std::string> answer_of(std::string const& text) {
  auto const start = text.find("what does it cost?\n\n") + 20;
  std::istringstream paragraphs(text.substr(start, text.find("\n\n![", start) - start));
  std::vector<std::string> sentences;
  for (std::string line; std::getline(paragraphs, line);) {
    if (!line.empty()) sentences.push_back(line);
  }
  return sentences;
}

TEST(Report, TheAnswerIsThreeShortSentences) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not on the PATH";
  Folder const folder;
  auto const sentences = answer_of(markdown_of(full(), folder.path));
  ASSERT_EQ(sentences.size(), 3U);
  for (std::string const& sentence : sentences) {
    std::istringstream words(sentence);
    auto const n = std::distance(std::istream_iterator<std::string>(words), {});
    EXPECT_LE(n, 50) << sentence;
  }
}

TEST(Report, WhatIsKeptComesFromTheRecords) {
  Folder const folder;
  std::string const text = markdown_of(full(), folder.path);
  EXPECT_TRUE(
      contains(text, "| gauss2 | quaternion | 2e-15 | 1e-16 | 1e-16 | 5e-11 | 5e-10 | norm, energy, \\|L\\| |"));
  EXPECT_TRUE(contains(text, "| rk4 | quaternion | 8e-11 | 2.5e-11 | 2.5e-11 |"));
  EXPECT_TRUE(contains(text, "keep norm, energy and |L| to round-off, but not the direction of L in space"));
}

TEST(Report, OnlyTheDirectionOfLTellsTheSigns) {
  Folder const folder;
  std::string const text = markdown_of(full(), folder.path);
  EXPECT_TRUE(contains(text, "| minus, Euler | 1.5e-16 | 7e-17 | 1.9e-16 | 1.09e-14 |"));
  EXPECT_TRUE(contains(text, "| plus, as printed | 1.5e-16 | 7e-17 | 0.273 | 15.6 |"));
  EXPECT_TRUE(contains(text, "only the angular momentum in space tells the signs apart"));
}

TEST(Report, ATiedSamplePeriodDoesNotConverge) {
  Folder const folder;
  std::string const text = markdown_of(full(), folder.path);
  EXPECT_TRUE(contains(text, "| 0.05 | 3.13e-11 | 0.02 |"));
  EXPECT_TRUE(contains(text, "tied, it grows from 5e-10 rad at h = 0.1 s to 0.0275 rad at h = 0.0125 s"));
  EXPECT_TRUE(contains(text, "so the error does not vanish"));
  // It is another problem: no ranking, no order, no claim.
  EXPECT_FALSE(contains(text, "| tether_capture case1,g1,coupled, 50 s |"));
}

TEST(Report, SectionsSayWhatTheyLack) {
  Folder const folder;
  Contents c;
  c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 12, 2e-15}, 0.1));
  std::string const text = markdown_of(c, folder.path);
  for (auto const* part :
       {"No run with fixed steps of a torque-free motion recorded", "so the signs cannot be compared",
        "so its effect cannot be shown", "Not compared here, having single runs",
        "No run was made both with and without projection, at equal step"}) {
    EXPECT_TRUE(contains(text, part)) << part;
  }
  EXPECT_FALSE(fs::exists(folder.path / "tables" / "answer.csv")) << "one run ranks nothing";
}

TEST(Report, CostsNameTheMachineAndTheirIntervals) {
  Folder const folder;
  Contents c = full();
  c.metas.push_back({{"cpu_model", "a made-up processor"}, {"virtualised", "true"}});
  EXPECT_TRUE(contains(markdown_of(c, folder.path),
                       "medians of 5 interleaved repetitions, their 95% intervals in the "
                       "CSV file; on a made-up processor, virtualised"));
  std::string const csv = slurp(folder.path / "tables" / "cheapest-1.csv");
  EXPECT_TRUE(contains(csv, "CPU time,low,high,at the target"));
  EXPECT_FALSE(contains(slurp(folder.path / "report.md"), "| CPU time | low |"));
}

TEST(Report, HeadlineIsDrawnFromWhatThereIs) {
  Folder const folder;
  Contents c = full();
  markdown_of(c, folder.path);
  std::string const csv = slurp(folder.path / "figures" / "headline.csv");
  EXPECT_TRUE(contains(csv, "|q.q - 1| against t [s],\"gauss2, 1 sweep\""));
  EXPECT_TRUE(contains(csv, "attitude error [rad] against CPU time of the solve [s],rk4"));
  std::erase_if(c.records, [](Record const& r) { return r.of.problem == "free_body"; });
  c.series.clear();
  Folder const other{folder.path / "other"};
  std::string const rest = markdown_of(c, other.path);
  EXPECT_FALSE(contains(rest, "figures/headline"));
  EXPECT_TRUE(contains(rest, "tables/headline.csv")) << "the captured target's drift is known";
}

}  // namespace
}  // namespace polhode::report
