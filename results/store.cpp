#include "results/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// "FILE: cannot VERB: No space left on device". To be called while errno still says why.
[[noreturn]] void io_error(fs::path const& file, std::string_view verb) {
  throw StoreError(fmt::format("{}: cannot {}: {}", file.string(), verb, std::generic_category().message(errno)));
}

// --- Reading ---------------------------------------------------------------------------------------------------------

/// How a file falls into lines: the bytes of those that end in a newline, and what stands after the last newline.
struct Lines {
  std::uintmax_t complete = 0;
  std::string torn;
};

/// The next line, without its newline; false for what stands after the last one, and for more than `longest` bytes, of
/// which no more is taken: std::getline would fill the memory.
bool next_line(std::istream& in, std::string& line, std::size_t longest) {
  line.clear();
  for (std::array<char, 1 << 12> part; line.size() <= longest; in.clear()) {
    in.getline(part.data(), part.size());
    auto const taken = std::size_t(in.gcount());
    line.append(part.data(), in.good() ? taken - 1 : taken);  // good: the newline is taken, and counted
    bool const goes_on = in.rdstate() == std::ios::failbit;
    if (!goes_on) return in.good();
  }
  return false;
}

/// Calls visit(line, number) for every complete line of a file.
Lines for_each_line(fs::path const& file, std::function<void(std::string const&, std::size_t)> const& visit) {
  constexpr std::size_t longest = std::size_t{256} << 20;
  std::ifstream in = open_regular(file);
  Lines lines;
  std::size_t number = 1;
  for (; next_line(in, lines.torn, longest); ++number) {
    lines.complete += lines.torn.size() + 1;
    visit(lines.torn, number);
  }
  if (in.bad()) io_error(file, "read");
  if (lines.torn.size() > longest)
    throw StoreError(fmt::format("{}:{}: longer than {} MiB: no record", file.string(), number, longest >> 20));
  return lines;
}

Json parse(std::string const& line) {
  try {
    return Json::parse(line);
  } catch (nlohmann::json::parse_error const& error) {
    throw std::invalid_argument(fmt::format("not JSON (byte {}); a line must be one JSON object", error.byte));
  } catch (nlohmann::json::exception const&) {
    throw std::invalid_argument("a number too large for a double; a line must be one JSON object");
  }
}

/// Gathers the lines of all files into what they mean together.
class Collector {
 public:
  void take(std::string const& line, bool first) {
    Json const json = parse(line);
    std::string const kind = kind_of(json);
    if (first != (kind == "meta")) {
      throw std::invalid_argument(fmt::format("kind: \"{}\"; the first line, and no other, must be a meta", kind));
    }
    if (kind == "meta") contents_.metas.push_back(meta_from_json(json));
    if (kind == "begin") take(begin_from_json(json));
    if (kind == "series") take(series_from_json(json));
    if (kind == "run") take(record_from_json(json));
  }

  Contents finish() {
    for (Begin const& begin : open_) {
      auto& cells = contents_.unfinished;
      if (std::ranges::find(cells, begin.cell) == cells.end()) cells.push_back(begin.cell);
    }
    return std::move(contents_);
  }

 private:
  using Key = std::pair<std::string, std::string>;

  void take(Begin begin) {
    close(begin.cell, begin.build);
    open_.push_back(std::move(begin));
  }

  void take(Series series) {
    Key const key(series.cell, series.name);
    put(contents_.series, series_at_, key, std::move(series));
  }

  void take(Record record) {
    std::string const id = cell_id(record.of);
    if (record.cell != id) {
      throw std::invalid_argument(fmt::format("cell: \"{}\"; must be \"{}\", the id of the fields", record.cell, id));
    }
    close(record.cell, record.build);
    Key const key(record.cell, record.build);
    contents_.repeated += record_at_.contains(key);
    put(contents_.records, record_at_, key, std::move(record));
  }

  void close(std::string const& cell, std::string const& build) {
    std::erase_if(open_, [&](Begin const& begin) { return begin.cell == cell && begin.build == build; });
  }

  /// In place of an earlier one of the same key, or at the end.
  template <class T>
  static void put(std::vector<T>& values, std::map<Key, std::size_t>& places, Key const& key, T value) {
    auto const [place, is_new] = places.try_emplace(key, values.size());
    if (is_new) {
      values.push_back(std::move(value));
    } else {
      values[place->second] = std::move(value);
    }
  }

  Contents contents_;
  std::map<Key, std::size_t> record_at_;  ///< by cell and build
  std::map<Key, std::size_t> series_at_;  ///< by cell and name
  std::vector<Begin> open_;
};

// --- Writing ---------------------------------------------------------------------------------------------------------

/// Text of any encoding is written: what is not UTF-8 in a reason from outside must not cost the run.
std::string dump(Json const& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// What every file of ours begins with, up to the first free-form entry.
std::string meta_prefix() {
  std::string text = dump(to_json(Meta{}));
  text.pop_back();
  return text;
}

/// The bytes of an existing file's complete lines. Refuses a file that is not ours, which cutting would harm.
std::uintmax_t complete_bytes(fs::path const& file) {
  auto const check_first = [&](std::string const& line, std::size_t number) {
    if (number > 1) return;
    try {
      meta_from_json(parse(line));
    } catch (std::invalid_argument const& error) {
      throw StoreError(fmt::format("{}:1: {}", file.string(), error.what()));
    }
  };
  Lines const lines = for_each_line(file, check_first);
  std::string const prefix = meta_prefix();
  std::size_t const common = std::min(prefix.size(), lines.torn.size());
  if (lines.complete == 0 && lines.torn.compare(0, common, prefix, 0, common) != 0) {
    throw StoreError(fmt::format("{}:1: not a file of results; must begin with {}", file.string(), prefix));
  }
  return lines.complete;
}

/// A new file is safe only when its folder's entry is on disk too.
void sync_folder_of(fs::path const& file) {
  fs::path const folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  int const descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) io_error(folder, "open");
  int const failed = ::fsync(descriptor);
  int const reason = errno;
  ::close(descriptor);
  errno = reason;
  if (failed != 0) io_error(folder, "sync");
}

off_t size_of(std::FILE* out, fs::path const& file) {
  struct stat status {};
  if (::fstat(::fileno(out), &status) != 0) io_error(file, "open");
  return status.st_size;
}

}  // namespace

std::vector<fs::path> record_files(fs::path const& path) try {
  if (!fs::exists(path)) throw StoreError(fmt::format("{}: no such file or folder", path.string()));
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (fs::directory_entry const& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".jsonl" && !entry.is_directory()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
} catch (fs::filesystem_error const& error) {
  throw StoreError(fmt::format("{}: cannot be read: {}", path.string(), error.code().message()));
}

Contents read(fs::path const& path) {
  Collector collector;
  for (fs::path const& file : record_files(path)) {
    for_each_line(file, [&](std::string const& line, std::size_t number) {
      try {
        collector.take(line, number == 1);
      } catch (std::invalid_argument const& error) {
        throw StoreError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
      }
    });
  }
  Contents contents = collector.finish();
  contents.catalogue = read_catalogue(path);
  contents.benchmarks = read_benchmarks(path);
  contents.ensemble = read_ensemble(path);
  return contents;
}

void remove_records(fs::path const& folder) {
  std::vector<fs::path> const files = record_files(folder);
  for (fs::path const& file : files) complete_bytes(file);
  for (fs::path const& file : files) {
    errno = 0;
    if (::unlink(file.c_str()) != 0) io_error(file, "remove");
  }
}

bool is_own_name(std::string_view name) {
  bool const hidden = name.starts_with('.');
  bool const ours = name.starts_with(catalogue_file) || name.starts_with(benchmarks_file) ||
                    name.starts_with(ensemble_file);  // and their drafts
  return hidden || ours || name == "suite.toml" || name.ends_with(".jsonl");
}

Writer::Writer(fs::path const& file, Meta const& meta) : file_(file) {
  std::string const first_line = dump(to_json(meta));
  std::error_code unknown;
  std::uintmax_t const keep = fs::is_regular_file(file, unknown) ? complete_bytes(file) : 0;

  out_.reset(std::fopen(file.c_str(), "ae"));  // e: children must not inherit it
  if (!out_) io_error(file_, "open");
  // Unbuffered: a line that failed must not be written after all when the file is closed.
  std::setvbuf(out_.get(), nullptr, _IONBF, 0);
  if (size_of(out_.get(), file_) > static_cast<off_t>(keep)) {
    if (::ftruncate(::fileno(out_.get()), static_cast<off_t>(keep)) != 0) io_error(file_, "cut a torn line");
  }
  if (keep == 0) {
    append(first_line);
    sync_folder_of(file_);
  }
}

void Writer::begin(std::string const& cell, std::string const& build) {
  append(dump(to_json(Begin{cell, build})));
}

void Writer::series(Series const& series) {
  append(dump(to_json(series)));
}

void Writer::run(Record const& record) {
  std::string const id = cell_id(record.of);
  if (record.cell != id) {
    throw std::invalid_argument(fmt::format("cell: \"{}\"; must be \"{}\", the id of the fields", record.cell, id));
  }
  append(dump(to_json(record)));
}

void Writer::append(std::string const& line) {
  off_t const before = size_of(out_.get(), file_);
  std::string const text = line + '\n';
  bool const written = std::fwrite(text.data(), 1, text.size(), out_.get()) == text.size();
  if (written && ::fsync(::fileno(out_.get())) == 0) return;

  // Half a line must not stay in the way of the next one. If the cut fails too, the reader forgives a torn last line.
  int const reason = errno;
  [[maybe_unused]] int const cut = ::ftruncate(::fileno(out_.get()), before);
  errno = reason;
  io_error(file_, "write");
}

}  // namespace polhode::results
