#include "bench/job/result_folder.hpp"

#include <fmt/format.h>

#include "bench/process/provenance.hpp"
#include "bench/solve/catalogue.hpp"
#include "results/store.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench {
namespace {

namespace fs = std::filesystem;

fs::path const& made(fs::path const& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw results::StoreError(fmt::format("{}: {}", folder.string(), error.message()));
  return folder;
}

results::FolderLock locked(fs::path const& folder, RunOptions const& options) {
  bool const whole = options.shards <= 1 || options.fresh;
  return whole ? results::FolderLock(folder) : results::FolderLock(folder, options.shard, options.shards);
}

}  // namespace

ResultFolder::ResultFolder(fs::path const& folder, RunOptions const& options)
    : folder_(made(folder)), lock_(locked(folder, options)) {
  if (options.fresh) results::remove_records(folder);
}

std::set<std::string> ResultFolder::finished(bool retry_failed) const {
  results::Contents const contents = results::read(folder_);
  std::set<std::string> done;
  for (results::Record const& record : contents.records) {
    bool const good = record.status == results::Status::ok || record.status == results::Status::refused;
    if (record.build == build_id() && (good || !retry_failed)) done.insert(record.cell);
  }
  return done;
}

void ResultFolder::write_suite(Suite const& suite) const {
  results::write_text(folder_ / "suite.toml", suite.text);
  results::write_catalogue(folder_, catalogue_text());
  for (fs::path const& file : suite.files) {
    fs::path const copy = folder_ / file.filename();
    if (!fs::exists(copy) || !fs::equivalent(file, copy))
      fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
  }
}

}  // namespace polhode::bench
