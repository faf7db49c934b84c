/// Tables for a terminal: aligned, as wide as the window, coloured where that is wanted and nowhere else.
#include "results/terminal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace polhode::results {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Rows = std::vector<std::vector<TextCell>>;

std::vector<std::string> lines_of(std::string const& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<TextColumn> const columns{{"run"}, {"error", true}, {"status", false, true}};
Rows const rows{{{"free_body//quaternion/rk4/none/h=0.1"}, {"1.5e-9"}, {"ok"}}, {{"µ"}, {"12"}, {"diverged"}}};

TEST(TextTable, ColumnsAreAligned) {
  EXPECT_EQ(text_table(columns, rows, {}),
            "run                                    error  status\n"
            "free_body//quaternion/rk4/none/h=0.1  1.5e-9  ok\n"
            "µ                                         12  diverged\n");
}

TEST(TextTable, NothingIsWiderThanTheWindow) {
  for (std::size_t const width : {24u, 30u, 40u, 79u, 80u}) {
    for (std::string const& line : lines_of(text_table(columns, rows, {width, false})))
      EXPECT_LE(places(line), width) << line;
  }
  EXPECT_EQ(lines_of(text_table(columns, rows, {38, false}))[1], "free_body/…one/h=0.1  1.5e-9  ok");
}

TEST(TextTable, NumbersAndWhatIsKeptAreNeverShortened) {
  std::string const text = text_table(columns, rows, {10, false});
  EXPECT_THAT(text, AllOf(HasSubstr("1.5e-9"), HasSubstr("diverged"), HasSubstr("fr…1  ")));
}

TEST(TextTable, ColourSaysWhatIsMeantAndTakesNoPlace) {
  std::string const plain = text_table(columns, rows, {});
  std::string const text = text_table(columns, rows, {0, true});
  EXPECT_THAT(text, HasSubstr("\033[32mok\033[0m"));
  EXPECT_THAT(text, HasSubstr("\033[31mdiverged\033[0m"));
  std::string without;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\033')
      i = text.find('m', i);
    else
      without += text[i];
  }
  EXPECT_EQ(without, plain);
}

TEST(TextTable, WhatARecordHoldsCannotSteerTheTerminal) {
  EXPECT_EQ(text_table({{"reason"}}, {{{"a\033[2Jb\nc"}}}, {}), "reason\na?[2Jb?c\n");
}

TEST(Wrapped, WordsStayWhole) {
  EXPECT_EQ(wrapped("one two three", {7, false}), "one two\nthree");
  EXPECT_EQ(wrapped("incomprehensible as it is", {6, false}), "incomprehensible\nas it\nis");
  EXPECT_EQ(wrapped("one two three", {}), "one two three");
}

/// The environment of one test.
class OutletTest : public testing::Test {
 protected:
  void SetUp() override {
    for (auto const* name : {"NO_COLOR", "CLICOLOR_FORCE", "COLUMNS"}) ::unsetenv(name);
    ::setenv("TERM", "xterm", 1);
    ASSERT_EQ(::pipe(pipe_), 0);
  }
  void TearDown() override {
    for (auto const* name : {"NO_COLOR", "CLICOLOR_FORCE", "COLUMNS"}) ::unsetenv(name);
    for (int const descriptor : {pipe_[0], pipe_[1], master_, slave_}) {
      if (descriptor >= 0) ::close(descriptor);
    }
  }
  /// False if there are no terminals here.
  bool open_terminal(unsigned short width) {
    winsize size{};
    size.ws_row = 24;
    size.ws_col = width;
    return ::openpty(&master_, &slave_, nullptr, nullptr, &size) == 0;
  }

  int pipe_[2] = {-1, -1};
  int master_ = -1, slave_ = -1;
};

TEST_F(OutletTest, APipeIsPlainAndHasNoWidth) {
  Outlet const outlet = outlet_of(pipe_[1]);
  EXPECT_EQ(outlet.width, 0u);
  EXPECT_FALSE(outlet.colour);
  ::setenv("CLICOLOR_FORCE", "1", 1);
  EXPECT_TRUE(outlet_of(pipe_[1]).colour);
  ::setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(outlet_of(pipe_[1]).colour) << "who asks for none gets none";
  ::unsetenv("NO_COLOR");
  ::setenv("CLICOLOR_FORCE", "0", 1);
  EXPECT_FALSE(outlet_of(pipe_[1]).colour);
}

TEST_F(OutletTest, ATerminalHasBoth) {
  if (!open_terminal(92)) GTEST_SKIP() << "no pseudo-terminals here";
  EXPECT_EQ(outlet_of(slave_).width, 92u);
  EXPECT_TRUE(outlet_of(slave_).colour);
  ::setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(outlet_of(slave_).colour);
  ::setenv("NO_COLOR", "", 1);
  EXPECT_TRUE(outlet_of(slave_).colour) << "empty counts as unset";
  ::setenv("TERM", "dumb", 1);
  EXPECT_FALSE(outlet_of(slave_).colour);
}

TEST_F(OutletTest, ATerminalThatDoesNotTellItsWidth) {
  if (!open_terminal(0)) GTEST_SKIP() << "no pseudo-terminals here";
  EXPECT_EQ(outlet_of(slave_).width, 80u);
  ::setenv("COLUMNS", "123", 1);
  EXPECT_EQ(outlet_of(slave_).width, 123u);
}

}  // namespace
}  // namespace polhode::results
