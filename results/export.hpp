#pragma once
/// Records for other tools: CSV for spreadsheets and data frames, Google Benchmark JSON for its compare.py and for CI
/// services that track benchmarks.
#include <string>
#include <vector>

#include "results/store.hpp"

namespace polhode::results {

/// A header, then a row for each record; a column for each field of for_each_field, in its order. Null is empty;
/// numbers read back as the same double; set, claims and cpu_time_s are compact JSON, the last with each repetition in
/// `samples`. Quoted as in RFC 4180 where that
/// is needed; lines end in a newline alone.
std::string csv_text(std::vector<Record> const& records);

/// The timed runs of the newest build (that of the last meta), one benchmark each, named as run_name: a row for each
/// repetition, then one for their median (`aggregate_name`) with its interval. The time is the CPU time of a solve in
/// ns, as cpu_time and as real_time: no other time is measured. Counts and errors are user counters. Runs that were not
/// timed are left out.
std::string benchmark_json_text(Contents const& contents);

/// How many records benchmark_json_text leaves out: not timed, or of another build.
std::size_t left_out_of_benchmarks(Contents const& contents);

}  // namespace polhode::results
