#include "results/store.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace polhode::results;
using polhode::test::text_of;
namespace fs = std::filesystem;

Meta const meta{{"build", "b"}};
std::string const meta_line = R"({"schema":1,"kind":"meta","build":"b"})"
                              "\n";

Record run_of(std::string const& problem, std::int64_t steps = 1) {
  Record record;
  record.of.problem = problem;
  record.cell = cell_id(record.of);
  record.build = "b";
  record.steps = steps;
  return record;
}

std::string run_line(Record const& record) {
  return to_json(record).dump() + "\n";
}

std::string begin_line(Record const& record) {
  return to_json(Begin{record.cell, record.build}).dump() + "\n";
}

Series series_of(Record const& record, std::string const& name, double value) {
  return Series{record.cell, name, {"t"}, {"s"}, {{value}}};
}

void put(fs::path const& file, std::string const& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::vector<std::string> problems_of(Contents const& contents) {
  std::vector<std::string> problems;
  for (Record const& record : contents.records) problems.push_back(record.of.problem);
  return problems;
}

using Names = std::vector<std::string>;

std::string error_of(std::function<void()> const& f) {
  return polhode::test::complaint_of<StoreError>(f);
}

/// Each test has a folder of its own.
class Store : public testing::Test {
 protected:
  polhode::test::TemporaryFolder top;
  fs::path const folder = top.path, file = folder / "a.jsonl";
};

// --- What is written is read -----------------------------------------------------------------------------------------

TEST_F(Store, LinesStandInTheOrderOfTheCalls) {
  Record const a = run_of("a");
  Writer writer(file, meta);
  writer.begin(a.cell, a.build);
  writer.series(series_of(a, "drift", 2));
  writer.run(a);
  std::string const series_line = to_json(series_of(a, "drift", 2)).dump() + "\n";
  EXPECT_EQ(text_of(file), meta_line + begin_line(a) + series_line + run_line(a));

  for (fs::path const& path : {file, folder}) {
    Contents const contents = read(path);
    EXPECT_EQ(contents.metas, std::vector<Meta>{meta});
    EXPECT_EQ(problems_of(contents), Names{"a"});
    ASSERT_EQ(contents.series.size(), 1u);
    EXPECT_EQ(contents.series[0].rows[0][0], 2);
    EXPECT_TRUE(contents.unfinished.empty());
  }
}

TEST_F(Store, ContinuesAFile) {
  Writer(file, meta).run(run_of("a"));
  Writer(file, Meta{{"another", "meta"}}).run(run_of("b"));
  EXPECT_EQ(text_of(file), meta_line + run_line(run_of("a")) + run_line(run_of("b")));
}

TEST_F(Store, FilesAreReadInTheOrderOfTheirNamesAndOthersAreNot) {
  Writer(folder / "b.jsonl", Meta{{"n", "2"}}).run(run_of("second"));
  Writer(folder / "a.jsonl", Meta{{"n", "1"}}).run(run_of("first"));
  Writer(folder / "c.jsonl", Meta{{"n", "3"}}).run(run_of("third"));
  put(folder / "notes.txt", "not JSON");
  fs::create_directory(folder / "folder.jsonl");
  Contents const contents = read(folder);
  EXPECT_EQ(problems_of(contents), (Names{"first", "second", "third"}));
  EXPECT_EQ(contents.metas, (std::vector<Meta>{{{"n", "1"}}, {{"n", "2"}}, {{"n", "3"}}}));
}

TEST_F(Store, EmptyFolderAndEmptyFileHoldNothing) {
  EXPECT_TRUE(read(folder).records.empty());
  put(file, "");
  EXPECT_TRUE(read(folder).metas.empty());
  EXPECT_TRUE(read(file).metas.empty());
  Writer(file, meta).run(run_of("a"));
  EXPECT_EQ(problems_of(read(file)), Names{"a"});
}

TEST_F(Store, LastRunOfABuildCounts) {
  Record other_build = run_of("a", 3);
  other_build.build = "c";
  Writer writer(file, meta);
  writer.run(run_of("a", 1));
  writer.run(run_of("b", 1));
  writer.run(other_build);
  writer.run(run_of("a", 2));
  Contents const contents = read(file);
  EXPECT_EQ(problems_of(contents), (Names{"a", "b", "a"}));
  EXPECT_EQ(contents.records[0].steps, 2);
  EXPECT_EQ(contents.records[1].steps, 1);
  EXPECT_EQ(contents.records[2].steps, 3);
}

TEST_F(Store, LastSeriesOfANameCounts) {
  Writer writer(file, meta);
  writer.series(series_of(run_of("a"), "drift", 1));
  writer.series(series_of(run_of("a"), "history", 2));
  writer.series(series_of(run_of("a"), "drift", 3));
  Contents const contents = read(file);
  ASSERT_EQ(contents.series.size(), 2u);
  EXPECT_EQ(contents.series[0].rows[0][0], 3);
  EXPECT_EQ(contents.series[1].rows[0][0], 2);
}

TEST_F(Store, BeginWithoutRunIsUnfinished) {
  Record const a = run_of("a");
  Record const b = run_of("b");
  Record const c = run_of("c");
  Writer writer(file, meta);
  writer.begin(a.cell, a.build);  // died, and done the second time
  writer.begin(a.cell, a.build);
  writer.run(a);
  writer.begin(b.cell, b.build);  // died twice
  writer.begin(b.cell, b.build);
  writer.run(c);
  writer.begin(c.cell, c.build);  // done, and died when run afresh
  EXPECT_EQ(read(file).unfinished, (Names{b.cell, c.cell}));
}

TEST_F(Store, RunOfAnotherBuildFinishesNothing) {
  Record const a = run_of("a");
  Writer writer(file, meta);
  writer.begin(a.cell, "another build");
  writer.run(a);
  EXPECT_EQ(read(file).unfinished, Names{a.cell});
}

TEST_F(Store, RunInALaterFileFinishes) {
  Record const a = run_of("a");
  Writer(folder / "1.jsonl", meta).begin(a.cell, a.build);
  Writer(folder / "2.jsonl", meta).run(a);
  EXPECT_TRUE(read(folder).unfinished.empty());
}

TEST_F(Store, ReasonOfAnyEncodingIsWritten) {
  Record a = run_of("a");
  a.reason = "line\nbreak, and a byte that is not UTF-8: \xff";
  Writer(file, meta).run(a);
  EXPECT_EQ(read(file).records.at(0).reason, "line\nbreak, and a byte that is not UTF-8: \xEF\xBF\xBD");
}

// --- Kills -----------------------------------------------------------------------------------------------------------

TEST_F(Store, TornRunAtEveryByte) {
  Record const a = run_of("a");
  Record const b = run_of("b");
  std::string const before = meta_line + begin_line(a) + run_line(a) + begin_line(b);
  std::string const last = run_line(b);
  for (std::size_t kept = 0; kept < last.size(); ++kept) {
    put(file, before + last.substr(0, kept));
    Contents const torn = read(file);
    ASSERT_EQ(problems_of(torn), Names{"a"}) << kept;
    ASSERT_EQ(torn.unfinished, Names{b.cell}) << kept;

    Writer(file, meta).run(b);
    ASSERT_EQ(text_of(file), before + last) << kept;
  }
  Contents const whole = read(file);
  EXPECT_EQ(problems_of(whole), (Names{"a", "b"}));
  EXPECT_TRUE(whole.unfinished.empty());
}

TEST_F(Store, TornMetaAtEveryByte) {
  for (std::size_t kept = 0; kept < meta_line.size(); ++kept) {
    put(file, meta_line.substr(0, kept));
    ASSERT_TRUE(read(file).metas.empty()) << kept;
    Writer(file, meta).run(run_of("a"));
    ASSERT_EQ(text_of(file), meta_line + run_line(run_of("a"))) << kept;
  }
}

TEST_F(Store, TornLineInOneFileLeavesTheOthersWhole) {
  put(folder / "1.jsonl", meta_line + run_line(run_of("a")) + "{\"sch");
  put(folder / "2.jsonl", meta_line + run_line(run_of("b")));
  EXPECT_EQ(problems_of(read(folder)), (Names{"a", "b"}));
}

TEST_F(Store, WhatWasAcknowledgedSurvivesAKill) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  pid_t const child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    Writer writer(file, meta);
    for (int i = 0;; ++i) {
      writer.run(run_of(std::to_string(i)));
      if (::write(pipe_ends[1], "x", 1) != 1) ::_exit(1);
    }
  }
  ::close(pipe_ends[1]);
  std::size_t acknowledged = 0;
  char byte = 0;
  while (acknowledged < 20 && ::read(pipe_ends[0], &byte, 1) == 1) ++acknowledged;
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(pipe_ends[0]);
  EXPECT_EQ(acknowledged, 20u);
  EXPECT_GE(read(file).records.size(), acknowledged);
}

// --- Damage ----------------------------------------------------------------------------------------------------------

TEST_F(Store, DamageIsRefusedWithItsLine) {
  std::string const good = run_line(run_of("a"));
  std::string renamed = good;
  renamed.replace(renamed.find("\"problem\":\"a\""), 13, "\"problem\":\"z\"");
  std::string const old_id = run_of("a").cell;
  std::string const new_id = run_of("z").cell;
  std::string const kinds = "kind: \"jog\"; must be one of meta, begin, series, run";
  struct Case {
    std::string text;
    std::string message;
  };
  std::vector<Case> const cases{
      {meta_line + "{\"sch\n" + good, ":2: not JSON (byte 6); a line must be one JSON object"},
      {meta_line + good + "\n", ":3: not JSON (byte 1); a line must be one JSON object"},
      {meta_line + "{\"h\":1e999}\n", ":2: a number too large for a double; a line must be one JSON object"},
      {meta_line + "[]\n" + good, ":2: record: array; must be an object"},
      {meta_line + good + "{\"schema\":2,\"kind\":\"new\"}\n", ":3: schema: 2; must be 1"},
      {meta_line + good + "{\"schema\":1,\"kind\":\"jog\"}\n" + good, ":3: " + kinds},
      {good, ":1: kind: \"run\"; the first line, and no other, must be a meta"},
      {meta_line + meta_line, ":2: kind: \"meta\"; the first line, and no other, must be a meta"},
      {meta_line + renamed, ":2: cell: \"" + old_id + "\"; must be \"" + new_id + "\", the id of the fields"},
      {meta_line + "{\"schema\":1,\"kind\":\"begin\",\"cell\":\"c\"}\n",
       ":2: build: missing; every field must be there, null where it does not apply"},
      {meta_line + good.substr(0, 100) + good, ":2: not JSON (byte 103); a line must be one JSON object"},
  };
  for (Case const& c : cases) {
    put(file, c.text);
    EXPECT_EQ(error_of([&] { read(folder); }), file.string() + c.message);
  }
}

TEST_F(Store, WhatAReaderWouldRefuseIsNotWritten) {
  Writer writer(file, meta);
  Record stale = run_of("a");
  stale.of.problem = "z";
  Series ragged = series_of(stale, "drift", 1);
  ragged.units.clear();
  EXPECT_THROW(writer.run(stale), std::invalid_argument);
  EXPECT_THROW(writer.series(ragged), std::invalid_argument);
  EXPECT_EQ(text_of(file), meta_line);
}

TEST_F(Store, SomebodyElsesFileIsRefusedAndLeftAsItIs) {
  for (std::string const text : {"dear diary", "dear diary\nsecond line", "{\"schema\":1,\"kind\":\"run\"", "{}\n"}) {
    put(file, text);
    EXPECT_THROW(Writer(file, meta), StoreError) << text;
    EXPECT_EQ(text_of(file), text);
  }
  put(file, "dear diary");
  EXPECT_EQ(error_of([&] { Writer(file, meta); }),
            file.string() + ":1: not a file of results; must begin with {\"schema\":1,\"kind\":\"meta\"");
}

// --- The system says no ----------------------------------------------------------------------------------------------

TEST_F(Store, PathMustExist) {
  fs::path const nowhere = folder / "nowhere";
  EXPECT_EQ(error_of([&] { read(nowhere); }), nowhere.string() + ": no such file or folder");
  EXPECT_EQ(error_of([&] { Writer(nowhere / "a.jsonl", meta); }),
            (nowhere / "a.jsonl").string() + ": cannot open: No such file or directory");
}

TEST_F(Store, DiskFull) {
  EXPECT_EQ(error_of([] { Writer("/dev/full", meta); }), "/dev/full: cannot write: No space left on device");
}

/// Gives up the rights of root while it lives: to root, every folder is writable.
class AsNobody {
 public:
  AsNobody() : user_(::geteuid()) {
    if (user_ == 0) done_ = ::seteuid(65534) == 0;
  }
  ~AsNobody() {
    if (user_ == 0 && done_) done_ = ::seteuid(user_) == 0;
  }
  AsNobody(AsNobody const&) = delete;
  AsNobody& operator=(AsNobody const&) = delete;
  bool done() const { return done_; }

 private:
  uid_t user_;
  bool done_ = true;
};

TEST_F(Store, ReadOnlyFolderAndFile) {
  fs::path const present = folder / "present.jsonl";
  put(present, meta_line);
  fs::permissions(present, static_cast<fs::perms>(0444));  // it can be read
  fs::permissions(folder, static_cast<fs::perms>(0555));
  {
    AsNobody const nobody;
    if (!nobody.done()) GTEST_SKIP() << "root that cannot become somebody else";
    EXPECT_EQ(error_of([&] { Writer(file, meta); }), file.string() + ": cannot open: Permission denied");
    EXPECT_EQ(error_of([&] { Writer(present, meta); }), present.string() + ": cannot open: Permission denied");
  }
  fs::permissions(folder, static_cast<fs::perms>(0755));
  EXPECT_EQ(text_of(present), meta_line);
}

TEST_F(Store, UnreadableFolder) {
  fs::permissions(folder, fs::perms::none);
  {
    AsNobody const nobody;
    if (!nobody.done()) GTEST_SKIP() << "root that cannot become somebody else";
    EXPECT_EQ(error_of([&] { read(folder); }), folder.string() + ": cannot be read: Permission denied");
  }
  fs::permissions(folder, static_cast<fs::perms>(0755));
}

TEST_F(Store, HalfALineOnAFullDiskIsTakenBack) {
  Writer writer(file, meta);
  writer.run(run_of("a"));
  std::string const before = text_of(file);

  // A limit on the size of files fails in the middle of a line, as a full disk does.
  auto const old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  rlimit limit = old_limit;
  limit.rlim_cur = before.size() + 100;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::string const error = error_of([&] { writer.run(run_of("b")); });
  std::string const after = text_of(file);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  std::signal(SIGXFSZ, old_handler);

  EXPECT_EQ(error, file.string() + ": cannot write: File too large");
  EXPECT_EQ(after, before);
  writer.run(run_of("c"));
  EXPECT_EQ(problems_of(read(file)), (Names{"a", "c"}));
}

}  // namespace
