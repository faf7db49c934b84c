#pragma once
/// A short suite that is stopped on the way and run again, and all that was seen of its results.
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>

#include "results/store.hpp"
#include "tests/cli/process.hpp"

namespace polhode::cli::stopping {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// 3 groups (free_body to 2 s and to 4 s, pd_slew), 60 cells, 6 of them refused.
inline constexpr std::size_t cells = 60;
inline std::string const suite =
    "name = 'short'\n[timing]\nmin_time = 0.001\nrepetitions = 3\n"
    "[[sweep]]\nproblem = 'free_body'\nformulation = 'quaternion'\nintegrator = ['rk4', 'gauss2', 'dopri5']\n"
    "policy = ['none', 'project']\nh = [0.1, 0.25, 0.5]\nt_end = [2, 4]\n"
    "[[sweep]]\nproblem = 'free_body'\nformulation = 's3'\nintegrator = ['rkmk4', 'rk4']\nh = [0.1, 0.25, 0.5]\n"
    "t_end = [2, 4]\n"
    "[[sweep]]\nproblem = 'pd_slew'\nformulation = ['quaternion', 's3']\nintegrator = ['gauss2', 'gauss4']\n"
    "h = [0.1, 0.25, 0.5]\nt_end = 2\n";

/// The complete lines of every file of results, by name.
using Files = std::map<std::string, std::string>;

inline Files complete_lines(fs::path const& folder) {
  Files files;
  if (!fs::is_directory(folder)) return files;
  for (auto const& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".jsonl") continue;
    std::string const text = text_of(entry.path());
    files[entry.path().filename()] = text.substr(0, text.rfind('\n') + 1);  // npos + 1 = 0: no line
  }
  return files;
}

inline std::vector<Json> lines_of(std::string const& text) {
  std::vector<Json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(Json::parse(line));
  return lines;
}

/// What a folder holds, by cell. No run may be there twice.
struct Held {
  std::set<std::string> begun;
  std::map<std::string, Json> runs;  ///< without the columns that depend on the machine's speed
};

inline Held held_in(Files const& files) {
  Held held;
  for (auto const& [name, text] : files) {
    for (Json line : lines_of(text)) {
      if (line.at("kind") == "begin") held.begun.insert(line.at("cell"));
      if (line.at("kind") != "run") continue;
      for (std::string const key : {"cpu_time_s", "allocations_per_step"}) line.erase(key);
      std::string const cell = line.at("cell");
      EXPECT_TRUE(held.runs.emplace(cell, std::move(line)).second) << name << ": " << cell << " was there before";
    }
  }
  return held;
}

inline std::string group_of(Json const& run) {
  return run.at("problem").get<std::string>() + run.at("t_end").dump();
}

/// A run in one go: what every other must come to, and how long it takes.
struct Whole {
  explicit Whole(Folder const& folder) {
    folder.write("short.toml", suite);
    auto const start = Clock::now();
    Result const result = polhode(folder, "run short.toml --out whole");
    duration = Clock::now() - start;
    EXPECT_EQ(result.out, "whole: 60 cells: 54 ok, 6 refused, 0 failed, 0 already done\n") << result.err;
    Files const files = complete_lines(folder.path / "whole");
    runs = held_in(files).runs;
    EXPECT_EQ(runs.size(), cells);
    EXPECT_EQ(files.size(), 1U);
    for (auto const& [name, text] : files) bytes = text.size();
    for (auto const& [cell, run] : runs) groups[group_of(run)].insert(cell);
    EXPECT_EQ(groups.size(), 3U);
  }
  Seconds duration{};
  std::size_t bytes = 0;
  std::map<std::string, Json> runs;
  std::map<std::string, std::set<std::string>> groups;
};

/// One folder that is run by the same command, stopped and run again; and what was seen in it.
class Life {
 public:
  Life(Folder const& folder, Whole const& whole, int number)
      : folder_(folder),
        whole_(whole),
        name_("r" + std::to_string(number)),
        command_("run short.toml --out " + name_ + " --threads " + std::to_string(1 + number % 2)) {}

  /// Sends the signal after a random time, or once a random number of bytes is written: the time finds the passes,
  /// the bytes find the records.
  Result stop(int signal, std::mt19937& random, Seconds* wait = nullptr) {
    double const part = 0.5 * std::generate_canonical<double, 32>(random);
    bool const by_bytes = random() % 3 == 0;
    std::size_t const wanted = bytes() + std::size_t(part * double(whole_.bytes));
    auto const start = Clock::now();
    Process process(folder_.path, split(command_));
    auto const until = start + (by_bytes ? whole_.duration : whole_.duration * part);
    while (Clock::now() < until && !(by_bytes && bytes() >= wanted))
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    see();
    auto const stopped = Clock::now();
    process.signal(signal);
    Result result = process.finish();
    if (wait != nullptr) *wait = Clock::now() - stopped;
    look();
    return result;
  }

  /// Every line that was ever seen is still there.
  void see() {
    Files const now = complete_lines(folder_.path / name_);
    for (auto const& [name, text] : seen_) {
      ASSERT_TRUE(now.contains(name)) << name << " is gone";
      ASSERT_TRUE(now.at(name).starts_with(text)) << name << " is not what it was, and more";
    }
    for (auto const& [name, text] : now)
      if (!seen_.contains(name)) newest_ = name;
    seen_ = now;
  }

  /// ... and the store reads as what the lines say, and that is part of the whole.
  void look() {
    see();
    if (!fs::is_directory(folder_.path / name_)) return;
    results::Contents contents;
    ASSERT_NO_THROW(contents = results::read(folder_.path / name_));
    Held held = held_in(seen_);
    EXPECT_EQ(contents.repeated, 0U);
    EXPECT_EQ(contents.records.size(), held.runs.size());
    for (auto const& record : contents.records) EXPECT_TRUE(held.runs.contains(record.cell)) << record.cell;
    for (auto const& [cell, run] : held.runs) {
      ASSERT_TRUE(whole_.runs.contains(cell)) << cell;
      EXPECT_EQ(run, whole_.runs.at(cell));
      held.begun.erase(cell);
    }
    EXPECT_EQ(std::set(contents.unfinished.begin(), contents.unfinished.end()), held.begun);
  }

  /// Where the last process was, by the last line that it wrote.
  std::string phase() const {
    if (!seen_.contains(newest_) || newest_ == stopped_in_) return "start";
    std::vector<Json> const lines = lines_of(seen_.at(newest_));
    if (lines.size() < 2) return "start";
    if (lines.back().at("kind") != "begin") return "records";
    Held const held = held_in({{newest_, seen_.at(newest_)}});
    Held const all = held_in(seen_);
    auto const& group = whole_.groups.at(group_of(whole_.runs.at(lines.back().at("cell"))));
    bool const begun = std::ranges::all_of(
        group, [&](auto const& cell) { return held.begun.contains(cell) || all.runs.contains(cell); });
    return begun ? "timing" : "accuracy";
  }
  void note_stop() { stopped_in_ = newest_; }

  /// Runs to the end; then nothing is missing, and one more run finds nothing to do.
  void finish() {
    Held const before = held_in(seen_);
    std::size_t const refused = std::size_t(std::ranges::count_if(whole_.runs, [&](auto const& r) {
      return r.second.at("status") == "refused" && !before.runs.contains(r.first);
    }));
    std::string const expected = name_ + ": 60 cells: " + std::to_string(cells - before.runs.size() - refused) +
                                 " ok, " + std::to_string(refused) + " refused, 0 failed, " +
                                 std::to_string(before.runs.size()) + " already done\n";
    Result const rest = polhode(folder_, command_);
    EXPECT_EQ(rest.code, 0) << rest.err;
    EXPECT_EQ(rest.out, expected);
    look();
    EXPECT_EQ(held_in(seen_).runs, whole_.runs);
    EXPECT_TRUE(results::read(folder_.path / name_).unfinished.empty());

    Files const files = seen_;
    Result const idle = polhode(folder_, command_);
    EXPECT_EQ(idle.code, 0) << idle.err;
    EXPECT_EQ(idle.out, name_ + ": 60 cells: 0 ok, 0 refused, 0 failed, 60 already done\n");
    EXPECT_EQ(complete_lines(folder_.path / name_), files);
  }

 private:
  std::size_t bytes() const {
    std::size_t sum = 0;
    std::error_code none;
    for (auto const& entry : fs::directory_iterator(folder_.path / name_, none))
      if (entry.path().extension() == ".jsonl") sum += entry.file_size();
    return sum;
  }

  Folder const& folder_;
  Whole const& whole_;
  std::string name_, command_, newest_, stopped_in_;
  Files seen_;
};

}  // namespace polhode::cli::stopping
