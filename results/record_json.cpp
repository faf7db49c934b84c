/// The record as JSON, field by field, and back: a reader says which field is wrong, and what would be right.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "results/record.hpp"

namespace polhode::results {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kinds{"meta", "begin", "series", "run"};

[[noreturn]] void complain(std::string_view field, std::string_view what, std::string_view right) {
  throw std::invalid_argument(fmt::format("{}: {}; {}", field, what, right));
}

/// What stands at a field, for a message: strings in full, since they are what people mistype.
std::string shown(Json const& json) {
  if (json.is_string()) return fmt::format("\"{}\"", json.get_ref<std::string const&>());
  if (json.is_number()) return json.dump();
  return json.type_name();
}

// --- Writing ---------------------------------------------------------------------------------------------------------

Json encode(std::string const& text) {
  return Json(text);
}

Json encode(Status status) {
  return Json(std::string(name_of(status)));
}

Json encode(std::int64_t number) {
  return Json(number);
}

Json encode(double number) {
  if (!std::isfinite(number)) return Json(nullptr);
  return Json(number);
}

Json encode(Claim const& claim);
Json encode(CpuTime const& time);

template <class T>
Json encode(std::optional<T> const& value) {
  if (!value) return Json(nullptr);
  return encode(*value);
}

template <class T>
Json encode(std::vector<T> const& values) {
  Json array = Json::array();
  for (T const& value : values) array.push_back(encode(value));
  return array;
}

template <class T>
Json encode(std::map<std::string, T> const& values) {
  Json object = Json::object();
  for (auto const& [name, value] : values) object[name] = encode(value);
  return object;
}

Json encode(Claim const& claim) {
  Json object = Json::object();
  object["value"] = encode(claim.value);
  object["published"] = encode(claim.published);
  object["verdict"] = encode(claim.verdict);
  return object;
}

Json encode(CpuTime const& time) {
  Json object = Json::object();
  object["median"] = encode(time.median);
  object["low"] = encode(time.low);
  object["high"] = encode(time.high);
  object["repetitions"] = encode(std::int64_t{time.repetitions});
  if (!time.samples.empty()) object["samples"] = encode(time.samples);
  return object;
}

Json start(std::string_view kind) {
  Json object = Json::object();
  object["schema"] = schema;
  object["kind"] = kind;
  return object;
}

// --- Reading ---------------------------------------------------------------------------------------------------------

/// An object whose members must all be there and must all be asked for.
class Members {
 public:
  /// `path` is the object's own field name, "" at the top.
  Members(Json const& object, std::string path) : object_(object), path_(std::move(path)) {
    if (!object.is_object()) complain(path_, shown(object), "must be an object");
  }

  std::string where(std::string_view name) const {
    if (path_.empty()) return std::string(name);
    return fmt::format("{}.{}", path_, name);
  }

  Json const& take(std::string_view name) {
    auto const found = object_.find(name);
    if (found == object_.end()) {
      complain(where(name), "missing", "every field must be there, null where it does not apply");
    }
    taken_.push_back(name);
    return *found;
  }

  void nothing_left() const {
    if (taken_.size() == object_.size()) return;
    for (auto const& item : object_.items()) {
      if (std::ranges::find(taken_, item.key()) == taken_.end()) {
        complain(where(item.key()), "unknown field", fmt::format("must be one of {}", fmt::join(taken_, ", ")));
      }
    }
  }

 private:
  Json const& object_;
  std::string path_;
  std::vector<std::string_view> taken_;
};

bool is_number_or_null(Json const& json) {
  return json.is_number() || json.is_null();
}

double number_or_nan(Json const& json) {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  return json.get<double>();
}

void decode(Json const& json, std::string const& where, std::string& text) {
  if (!json.is_string()) complain(where, shown(json), "must be a string");
  text = json.get<std::string>();
}

void decode(Json const& json, std::string const& where, Status& status) {
  std::string name;
  decode(json, where, name);
  status = status_of(name);
}

void decode(Json const& json, std::string const& where, std::int64_t& number) {
  bool const integer = json.is_number_integer();
  bool const fits = !json.is_number_unsigned() || std::in_range<std::int64_t>(json.get<std::uint64_t>());
  if (!integer || !fits) complain(where, shown(json), "must be an integer of 64 bits");
  number = json.get<std::int64_t>();
}

void decode(Json const& json, std::string const& where, int& number) {
  std::int64_t wide = 0;
  decode(json, where, wide);
  if (!std::in_range<int>(wide)) complain(where, shown(json), "must be an integer of 32 bits");
  number = static_cast<int>(wide);
}

void decode(Json const& json, std::string const& where, double& number) {
  if (!is_number_or_null(json)) complain(where, shown(json), "must be a number or null");
  number = number_or_nan(json);
}

void decode(Json const& json, std::string const& where, Claim& claim);
void decode(Json const& json, std::string const& where, CpuTime& time);

template <class T>
void decode(Json const& json, std::string const& where, std::optional<T>& value) {
  value.reset();
  if (!json.is_null()) decode(json, where, value.emplace());
}

/// Without the name of every element, which would cost more than all the rest of reading a series.
void decode(Json const& json, std::string const& where, std::vector<double>& numbers) {
  if (!json.is_array()) complain(where, shown(json), "must be an array of numbers");
  numbers.clear();
  for (Json const& element : json) {
    if (!is_number_or_null(element)) {
      complain(fmt::format("{}[{}]", where, numbers.size()), shown(element), "must be a number or null");
    }
    numbers.push_back(number_or_nan(element));
  }
}

template <class T>
void decode(Json const& json, std::string const& where, std::vector<T>& values) {
  if (!json.is_array()) complain(where, shown(json), "must be an array");
  values.clear();
  for (Json const& element : json) {
    std::string const place = fmt::format("{}[{}]", where, values.size());
    decode(element, place, values.emplace_back());
  }
}

void decode(Json const& json, std::string const& where, std::map<std::string, std::vector<double>>& set) {
  if (!json.is_object()) complain(where, shown(json), "must be an object of arrays of numbers");
  set.clear();
  for (auto const& item : json.items()) {
    std::vector<double>& numbers = set[item.key()];
    if (is_number_or_null(item.value())) {
      numbers.push_back(number_or_nan(item.value()));
    } else {
      decode(item.value(), fmt::format("{}.{}", where, item.key()), numbers);
    }
  }
}

void decode(Json const& json, std::string const& where, std::map<std::string, Claim>& claims) {
  if (!json.is_object()) complain(where, shown(json), "must be an object of claims");
  claims.clear();
  for (auto const& item : json.items()) {
    decode(item.value(), fmt::format("{}.{}", where, item.key()), claims[item.key()]);
  }
}

void decode(Json const& json, std::string const& where, Claim& claim) {
  Members members(json, where);
  decode(members.take("value"), members.where("value"), claim.value);
  decode(members.take("published"), members.where("published"), claim.published);
  decode(members.take("verdict"), members.where("verdict"), claim.verdict);
  members.nothing_left();
}

void decode(Json const& json, std::string const& where, CpuTime& time) {
  Members members(json, where);
  decode(members.take("median"), members.where("median"), time.median);
  decode(members.take("low"), members.where("low"), time.low);
  decode(members.take("high"), members.where("high"), time.high);
  decode(members.take("repetitions"), members.where("repetitions"), time.repetitions);
  if (json.contains("samples")) decode(members.take("samples"), members.where("samples"), time.samples);
  members.nothing_left();
}

/// The members of a whole record of that kind.
Members open(Json const& json, std::string_view kind) {
  std::string const found = kind_of(json);
  if (found != kind) complain("kind", fmt::format("\"{}\"", found), fmt::format("must be \"{}\" here", kind));
  Members members(json, "");
  members.take("schema");
  members.take("kind");
  return members;
}

void check_shape(Series const& series) {
  std::size_t const width = series.columns.size();
  if (series.units.size() != width) {
    complain("units", fmt::format("{} units for {} columns", series.units.size(), width), "must be one per column");
  }
  for (std::size_t i = 0; i < series.rows.size(); ++i) {
    if (series.rows[i].size() != width) {
      complain(fmt::format("rows[{}]", i), fmt::format("{} numbers for {} columns", series.rows[i].size(), width),
               "must be one per column");
    }
  }
}

}  // namespace

Json to_json(Record const& record) {
  Json json = start("run");
  for_each_field(record, [&](char const* name, std::string_view, auto const& member) { json[name] = encode(member); });
  return json;
}

Json to_json(Begin const& begin) {
  Json json = start("begin");
  json["cell"] = encode(begin.cell);
  json["build"] = encode(begin.build);
  return json;
}

Json to_json(CpuTime const& time) {
  return encode(time);
}

Json to_json(Series const& series) {
  check_shape(series);
  Json json = start("series");
  json["cell"] = encode(series.cell);
  json["name"] = encode(series.name);
  json["columns"] = encode(series.columns);
  json["units"] = encode(series.units);
  json["rows"] = encode(series.rows);
  return json;
}

Json to_json(Meta const& meta) {
  Json json = start("meta");
  for (auto const& [name, text] : meta) {
    if (name == "schema" || name == "kind") {
      complain(name, "a name that every record has", "must have another name in a meta");
    }
    json[name] = encode(text);
  }
  return json;
}

std::string kind_of(Json const& json) {
  if (!json.is_object()) complain("record", shown(json), "must be an object");
  Members members(json, "");
  Json const& version = members.take("schema");
  if (version != schema) complain("schema", shown(version), fmt::format("must be {}", schema));
  Json const& kind = members.take("kind");
  bool const known = kind.is_string() && std::ranges::find(kinds, kind.get_ref<std::string const&>()) != kinds.end();
  if (!known) complain("kind", shown(kind), fmt::format("must be one of {}", fmt::join(kinds, ", ")));
  return kind.get<std::string>();
}

Record record_from_json(Json const& json) {
  // Younger than the schema: files from before do not have them, which says the same as null.
  constexpr std::array<std::string_view, 5> younger{"position_defect_max", "velocity_defect_max",
                                                    "acceleration_defect_max", "multiplier_error_max", "bodies"};
  Members members = open(json, "run");
  Record record;
  for_each_field(record, [&](char const* name, std::string_view, auto& member) {
    bool const may_miss = std::ranges::find(younger, name) != younger.end();
    if (!may_miss || json.contains(name)) decode(members.take(name), name, member);
  });
  members.nothing_left();
  return record;
}

Begin begin_from_json(Json const& json) {
  Members members = open(json, "begin");
  Begin begin;
  decode(members.take("cell"), "cell", begin.cell);
  decode(members.take("build"), "build", begin.build);
  members.nothing_left();
  return begin;
}

CpuTime cpu_time_from_json(Json const& json, std::string const& where) {
  CpuTime time;
  decode(json, where, time);
  return time;
}

Series series_from_json(Json const& json) {
  Members members = open(json, "series");
  Series series;
  decode(members.take("cell"), "cell", series.cell);
  decode(members.take("name"), "name", series.name);
  decode(members.take("columns"), "columns", series.columns);
  decode(members.take("units"), "units", series.units);
  decode(members.take("rows"), "rows", series.rows);
  members.nothing_left();
  check_shape(series);
  return series;
}

Meta meta_from_json(Json const& json) {
  open(json, "meta");
  Meta meta;
  for (auto const& item : json.items()) {
    if (item.key() == "schema" || item.key() == "kind") continue;
    decode(item.value(), item.key(), meta[item.key()]);
  }
  return meta;
}

}  // namespace polhode::results
