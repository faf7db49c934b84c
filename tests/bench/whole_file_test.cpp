/// What a reader is given instead of a file: devices, pipes, folders, more than it can hold. Every reader says so.
#include "results/whole_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <functional>
#include <map>

#include "bench/cell/certificate.hpp"
#include "bench/input/suite.hpp"
#include "bench/input/suite_graphs.hpp"
#include "bench/input/trajectory.hpp"
#include "problems/parameters.hpp"
#include "results/golden.hpp"
#include "results/store.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/small_vocabulary.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using polhode::test::complaint_of;
using testing::EndsWith;
using testing::HasSubstr;

/// A folder with a file, and with what is none.
class WholeFile : public testing::Test {
 protected:
  WholeFile() {
    temporary_.write("file", text);
    temporary_.write("huge", "");
    fs::create_directory(folder / "directory");
    fs::create_symlink("/dev/zero", folder / "device");
    EXPECT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    fs::resize_file(folder / "huge", most_lines + 1);  // a hole, which takes no room
  }
  void put(std::string const& name, std::string const& what) const { temporary_.write(name, what); }

  std::string const text = std::string("a\0b\r\n", 5) + "no newline at the end";

 private:
  test::TemporaryFolder temporary_;

 protected:
  fs::path const folder = temporary_.path;
};

TEST_F(WholeFile, IsReadByteForByte) {
  EXPECT_EQ(read_whole(folder / "file"), text);
  EXPECT_EQ(read_whole(folder / "file", text.size()), text);
  EXPECT_EQ(read_whole("/proc/self/cmdline").empty(), false) << "a file without a size";
}

TEST_F(WholeFile, IsNotReadBeyondItsLimit) {
  EXPECT_THAT(complaint_of<StoreError>([&] { read_whole(folder / "file", text.size() - 1); }),
              EndsWith("is larger than 0 MiB"));
  EXPECT_THAT(complaint_of<StoreError>([&] { read_whole("/proc/self/cmdline", 1); }), HasSubstr("is larger than"));
}

TEST_F(WholeFile, MayBeAbsent) {
  auto const length = [](std::string const& all) { return all.size(); };
  EXPECT_EQ(read_if_there(folder / "absent", length), std::nullopt);
  EXPECT_EQ(read_if_there(folder / "file" / "below", length), std::nullopt);
  EXPECT_EQ(read_if_there(folder / "file", length), text.size());
  auto const refuse = [](std::string const&) -> int { throw std::invalid_argument("why"); };
  EXPECT_EQ(complaint_of<StoreError>([&] { read_if_there(folder / "file", refuse); }),
            (folder / "file").string() + ": why");
}

/// Every reader of a file that comes from outside: what it says of the one at `file`.
std::map<std::string, std::function<std::string(fs::path const& file)>> const readers{
    {"records", [](fs::path const& file) { return complaint_of<StoreError>([&] { read(file); }); }},
    {"golden", [](fs::path const& file) { return complaint_of<StoreError>([&] { read_golden(file); }); }},
    {"suite",
     [](fs::path const& file) {
       return complaint_of<bench::SuiteError>([&] { bench::read_suite(file, bench::test::small_vocabulary()); });
     }},
    {"trajectory",
     [](fs::path const& file) {
       return complaint_of<bench::TrajectoryError>([&] { bench::read_trajectory(file, {{"q1"}, {}}); });
     }},
    {"reference", [](fs::path const& file) { return complaint_of<bench::ReferenceError>([&] { bench::load(file); }); }},
    {"graph",
     [](fs::path const& file) { return complaint_of<ParameterError>([&] { bench::read_graph_file(file); }); }}};

TEST_F(WholeFile, EveryReaderRefusesWhatIsNone) {
  for (auto const& [reader, error] : readers) {
    EXPECT_THAT(error(folder / "device"), EndsWith("device: is a device; give a file")) << reader;
    EXPECT_THAT(error(folder / "pipe"), EndsWith("pipe: is a pipe; give a file")) << reader;
    EXPECT_THAT(error(folder / "huge"), HasSubstr("huge: is larger than ")) << reader;
    bool const of_folders = reader == "records", may_be_absent = reader == "golden";
    if (!of_folders) {
      EXPECT_THAT(error(folder / "directory"), EndsWith("directory: is a directory; give a file")) << reader;
    }
    if (!may_be_absent) {
      EXPECT_THAT(error(folder / "absent"),
                  HasSubstr(of_folders ? "absent: no such file or folder" : "absent: cannot be read: No such file"))
          << reader;
    }
  }
}

/// The same of those that find their file in a result folder.
TEST_F(WholeFile, EveryFileOfAResultFolderIsOne) {
  for (std::string const name : {"catalogue.json", "benchmarks.json", "ensemble.json", "a.jsonl"}) {
    for (std::string const other : {"device", "pipe", "huge"}) {
      fs::create_symlink(other, folder / name);
      EXPECT_THAT(complaint_of<StoreError>([&] { read(folder); }), HasSubstr("/" + name + ": is ")) << other;
      fs::remove(folder / name);
    }
  }
  EXPECT_NO_THROW(read(folder));
}

// --- Record files ----------------------------------------------------------------------------------------------------

std::string const meta_line = R"({"schema":1,"kind":"meta","build":"b"})"
                              "\n";

/// A folder with one file of records.
class RecordFiles : public WholeFile {
 protected:
  RecordFiles() { put("a.jsonl", meta_line); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (auto const& entry : fs::directory_iterator(folder)) all.push_back(entry.path().filename());
    std::ranges::sort(all);
    return all;
  }
};

TEST_F(RecordFiles, ALineWithoutEndIsNoRecord) {
  fs::resize_file(folder / "a.jsonl", std::uintmax_t{300} << 20);  // zeros, which take no room
  EXPECT_THAT(complaint_of<StoreError>([&] { read(folder); }), EndsWith("a.jsonl:2: longer than 256 MiB: no record"));
}

TEST_F(RecordFiles, LongLinesAreReadWhole) {
  std::string const opening = R"({"schema":1,"kind":"meta","note":")", closing = "\"}\n";
  for (std::size_t const length : {4094U, 4095U, 4096U, 8190U, 8191U, 100'000U}) {  // with and without the newline
    for (std::size_t const more : {0U, 1U}) {
      std::size_t const note = length + more - opening.size() - closing.size();
      put("a.jsonl", opening + std::string(note, 'x') + closing + std::string(length, '{'));  // and a torn one
      EXPECT_EQ(read(folder).metas.at(0).at("note").size(), note) << length;
    }
  }
}

TEST_F(RecordFiles, AreRemovedAndNothingElse) {
  auto const before = names();
  put("damaged.jsonl", meta_line + "damaged\n");
  put("born.jsonl", "");
  put("torn.jsonl", meta_line.substr(0, 10));
  fs::create_directory(folder / "folder.jsonl");
  remove_records(folder);
  std::vector<std::string> left = before;
  std::ranges::replace(left, "a.jsonl", "folder.jsonl");
  std::ranges::sort(left);
  EXPECT_EQ(names(), left);
}

TEST_F(RecordFiles, OfSomebodyElseAreNotRemovedNorAnyBesideThem) {
  auto const before = names();
  for (std::string const theirs : {"{\"role\":\"user\"}\n", "notes\n", "notes", "{\"schema\":1,\"kind\":\"run\"}\n"}) {
    put("z.jsonl", theirs);
    EXPECT_THAT(complaint_of<StoreError>([&] { remove_records(folder); }), HasSubstr("z.jsonl:1: ")) << theirs;
    EXPECT_EQ(read_whole(folder / "z.jsonl"), theirs);
  }
  fs::remove(folder / "z.jsonl");
  fs::create_symlink("pipe", folder / "z.jsonl");
  EXPECT_THAT(complaint_of<StoreError>([&] { remove_records(folder); }), EndsWith("z.jsonl: is a pipe; give a file"));
  fs::remove(folder / "z.jsonl");
  EXPECT_EQ(names(), before);
}

}  // namespace
}  // namespace polhode::results
