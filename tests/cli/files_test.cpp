// What is given instead of a file, and files of somebody else's.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

/// A reader would wait for its end for ever.
TEST(CliFiles, WhatIsNoFileIsNotRead) {
  Folder folder;
  ASSERT_EQ(::mkfifo((folder.path / "pipe").c_str(), 0600), 0);
  fs::create_directories(folder.path / "r");
  fs::create_symlink("../pipe", folder.path / "r/suite.toml");
  fs::create_symlink("/dev/zero", folder.path / "r/a.jsonl");
  for (auto const& [words, message] :
       std::map<std::string, std::string>{{"run ./pipe", "./pipe: is a pipe"},
                                          {"report pipe", "pipe: is a pipe"},
                                          {"report r", "r/a.jsonl: is a device"},
                                          {"check r", "r/suite.toml: is a pipe"},
                                          {"export /dev/zero", "/dev/zero: is a device"},
                                          {"compare pipe pipe", "pipe: is a pipe"},
                                          {"merge m r", "r/a.jsonl: is a device"},
                                          {"import pipe --problem free_body", "pipe: is a pipe"},
                                          {"simulate quaternion_sync --integrator rk4 --h 0.1 --set graph=pipe",
                                           "parameter graph: pipe: is a pipe"}}) {
    Result const result = polhode(folder, words);
    EXPECT_EQ(result.err, "polhode: " + message + "; give a file\n") << words;
    EXPECT_EQ(result.code, 5) << words;
  }
  EXPECT_FALSE(fs::exists(folder.path / "m"));
}

TEST(CliFiles, FreshRemovesNothingOfSomebodyElses) {
  Folder folder;
  folder.write(
      "q.toml",
      "name = 'q'\ntiming = { enabled = false }\n"
      "[[sweep]]\nproblem = 'free_body'\nformulation = 's3'\nintegrator = ['cf4', 'gauss2']\nh = [0.1, 0.25]\n");
  EXPECT_EQ(polhode(folder, "run q.toml --out r").code, 0);
  EXPECT_EQ(polhode(folder, "run q.toml --out r --fresh").out,
            "r: 4 cells: 4 ok, 0 refused, 0 failed, 0 already done\n");
  folder.write("r/chats.jsonl", "{\"role\":\"user\"}\n");
  auto const before = folder.contents();
  Result const result = polhode(folder, "run q.toml --out r --fresh");
  EXPECT_EQ(result.code, 5);
  EXPECT_THAT(result.err, testing::HasSubstr("polhode: r/chats.jsonl:1: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(folder.contents(), before);
}

}  // namespace
}  // namespace polhode::cli
