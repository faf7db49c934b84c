// Trajectories of other programs as CSV: what is read, what is reported, and what a mistake says.
#include "bench/input/trajectory.hpp"
#include "tests/support/complaint.hpp"

#include <gmock/gmock.h>

#include <sstream>

namespace polhode::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ColumnNames const two{.required = {"q1", "wx"}, .optional = {"s1"}};

TrajectoryTable read(std::string const& text) {
  std::istringstream in(text);
  return read_trajectory(in, "f.csv", two);
}
std::string refusal(std::string const& text) {
  return polhode::test::complaint_of<TrajectoryError>([&] { read(text); });
}

TEST(Trajectory, ColumnsInAnyOrderCommentsSpacesAndLineEnds) {
  TrajectoryTable const table =
      read("\xEF\xBB\xBF# a comment\r\nwx , s1, t ,q1\r\n\r\n# more\n+1e0,9, 0 , 2\r\n 3,9,0.5,4e-400\n");
  EXPECT_THAT(table.times, ElementsAre(0, 0.5));
  EXPECT_THAT(table.values, ElementsAre(2, 1, 0, 3));
  EXPECT_THAT(table.lines, ElementsAre(5, 6));
  EXPECT_THAT(table.remarks, IsEmpty());
}

TEST(Trajectory, LastLineNeedsNoNewline) {
  EXPECT_THAT(read("t,q1,wx\n0,1,2\n1,3,4").times, ElementsAre(0, 1));
}

TEST(Trajectory, UnsortedRowsAreSortedAndReported) {
  TrajectoryTable const table = read("t,q1,wx\n0,0,0\n2,2,2\n1,1,1\n3,3,3\n");
  EXPECT_THAT(table.times, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(table.values, ElementsAre(0, 0, 1, 1, 2, 2, 3, 3));
  EXPECT_THAT(table.lines, ElementsAre(2, 4, 3, 5));
  EXPECT_THAT(table.remarks, ElementsAre("times go back at 1 row(s), first at line 4: the rows were sorted"));
}

TEST(Trajectory, RepeatedTimesAndGapsAreReported) {
  TrajectoryTable const table = read("t,q1,wx\n0,0,0\n1,0,0\n1,0,0\n2,0,0\n3,0,0\n14,0,0\n15,0,0\n");
  ASSERT_EQ(table.remarks.size(), 2U);
  EXPECT_THAT(table.remarks[0], HasSubstr("1 row(s) repeat the time of another, first t = 1 s in lines 3 and 4"));
  EXPECT_THAT(table.remarks[1], HasSubstr("1 gap(s) in time, the widest of 11 s before line 7"));
  EXPECT_THAT(read("t,q1,wx\n0,0,0\n1,0,0\n2,0,0\n12,0,0\n").remarks, IsEmpty()) << "10 medians are no gap";
}

TEST(Trajectory, MistakesNameFileLineColumnAndWhatIsRight) {
  EXPECT_EQ(refusal(""), "f.csv: has no header; its first line must name columns: t, q1, wx");
  EXPECT_EQ(refusal("# nothing\n"), "f.csv: has no header; its first line must name columns: t, q1, wx");
  EXPECT_EQ(refusal("0,1,2\n1,2,3\n"),
            "f.csv:1: numbers where the header is expected: the first line must name columns: t, q1, wx");
  EXPECT_EQ(refusal("t;q1;wx\n"), "f.csv:1: columns are to be separated by commas");
  EXPECT_EQ(refusal("#\nt,q1\n"), "f.csv:2: column 'wx' is missing; there must be t, q1, wx");
  EXPECT_EQ(refusal("q1,wx\n"), "f.csv:1: column 't' is missing; there must be t, q1, wx");
  EXPECT_EQ(refusal("t,q1,wxx\n"), "f.csv:1: column 3: unknown column 'wxx'; did you mean 'wx'?");
  EXPECT_EQ(refusal("t,q1,wx,t\n"), "f.csv:1: column 4: 't' is named twice");
  EXPECT_EQ(refusal("t,q1,wx\n0,1,2\n1,2\n"), "f.csv:3: 2 value(s), but the header names 3 columns");
  EXPECT_EQ(refusal("t,q1,wx\n0,1,2,3\n"), "f.csv:2: 4 value(s), but the header names 3 columns");
  EXPECT_EQ(refusal("t,q1,wx\n0,1,nan\n"), "f.csv:2: column 3 (wx): 'nan' is not finite");
  EXPECT_EQ(refusal("t,q1,wx\n0,-inf,1\n"), "f.csv:2: column 2 (q1): '-inf' is not finite");
  EXPECT_EQ(refusal("t,q1,wx\n0,1e999,1\n"), "f.csv:2: column 2 (q1): '1e999' is not finite");
  EXPECT_EQ(refusal("t,q1,wx\n0,x\t1,1\n"), "f.csv:2: column 2 (q1): 'x?1' is not a number");
  EXPECT_EQ(refusal("t,q1,wx\n0,,1\n"), "f.csv:2: column 2 (q1): no value; a number is expected");
  EXPECT_EQ(refusal("t,q1,wx\n-1,0,1\n"), "f.csv:2: column 1 (t): -1 s; a trajectory begins at 0 s or later");
  EXPECT_EQ(refusal("t,q1,wx\n0,0,1\n"), "f.csv: has 1 row(s); a trajectory has at least two");
  EXPECT_EQ(refusal("t,q1,wx,s1\n0,0,1,nan\n"), "f.csv:2: column 4 (s1): 'nan' is not finite");
}

TEST(Trajectory, AnEndlessLineIsRefusedAndNotKept) {
  struct Endless : std::streambuf {
    int_type underflow() override {
      setg(buffer, buffer, buffer + sizeof buffer);
      return buffer[0];
    }
    char buffer[4096] = {};
  } zeros;
  std::istream in(&zeros);
  EXPECT_THROW(read_trajectory(in, "zeros", two), TrajectoryError);
}

}  // namespace
}  // namespace polhode::bench
