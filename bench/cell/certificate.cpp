#include "bench/cell/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/record.hpp"
#include "results/shallow.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench {
namespace {

std::string decimal(Quad x) {
  std::array<char, 64> text{};
  quadmath_snprintf(text.data(), text.size(), "%.34Qe", x);
  return text.data();
}
std::string hexadecimal(Quad x) {
  std::array<char, 64> text{};
  quadmath_snprintf(text.data(), text.size(), "%.28Qa", x);
  return text.data();
}

/// Names of the components of a state.
std::vector<std::string> names_of(QuadState const& state, Layout const& layout) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < state.size(); ++i)
    for (Column const& column : layout.columns())
      names.push_back(state.size() > 1 ? fmt::format("b{}.{}", i + 1, column.name) : column.name);
  return names;
}
Layout layout_of(std::vector<std::string> const& columns) {
  auto const has = [&](std::string const& end) {
    return std::any_of(columns.begin(), columns.end(), [&](std::string const& name) { return name.ends_with(end); });
  };
  return {.attitude = has("q4"), .rate = has("wz") || has("y3"), .position = has("vz")};
}

using Json = nlohmann::ordered_json;

Json contents_of(Certificate const& c) {
  std::vector<std::string> methods{"Taylor, degree 32, float128, flat quaternion", "Gauss, 8 stages, float128, S3"};
  Json closed_form;  // null
  if (c.closed_form) {
    methods.emplace_back("closed form, elliptic functions, float128");
    closed_form = *c.closed_form;
  }
  Json json{{"schema", results::schema},
            {"kind", "reference"},
            {"id", c.id},
            {"subject", c.subject},
            {"methods", methods},
            {"bar_rad", c.bar},
            {"disagreement_rad", c.disagreement},
            {"halving_rad", c.halving},
            {"closed_form_rad", closed_form},
            {"columns", names_of(c.states.at(0), c.layout)}};
  for (std::size_t k = 0; k < c.times.size(); ++k) {
    Json row{{"t", c.times[k]}};
    for (Quad x : numbers(c.states[k], c.layout)) {
      row["decimal"].push_back(decimal(x));
      row["hex"].push_back(hexadecimal(x));
    }
    json["states"].push_back(row);
  }
  return json;
}

}  // namespace

void save(Certificate const& certificate, std::filesystem::path const& folder) {
  Json json = contents_of(certificate);
  json["hash"] = results::hash_of(json.dump());
  results::write_whole(folder / (certificate.id + ".json"), json.dump(1) + '\n');
}

Certificate load(std::filesystem::path const& file) {
  auto const refuse = [&](std::string const& why) {
    return ReferenceError(fmt::format("{}: {}; make it anew with `polhode reference`", file.string(), why));
  };
  try {
    auto json = Json::parse(results::read_whole(file), results::shallow);
    std::string const hash = json.at("hash");
    json.erase("hash");
    if (results::hash_of(json.dump()) != hash)
      throw refuse("its contents do not match their hash: it was edited or damaged");
    Certificate c{.id = json.at("id"),
                  .subject = json.at("subject"),
                  .bar = json.at("bar_rad"),
                  .disagreement = json.at("disagreement_rad"),
                  .halving = json.at("halving_rad")};
    // Absent in certificates made before the closed form was a witness.
    if (auto const closed_form = json.find("closed_form_rad"); closed_form != json.end() && !closed_form->is_null())
      c.closed_form = closed_form->get<double>();
    std::vector<std::string> const columns = json.at("columns");
    c.layout = layout_of(columns);
    bool const whole_bodies = c.layout.size() > 0 && columns.size() % std::size_t(c.layout.size()) == 0;
    if (!whole_bodies || columns.empty()) throw refuse("its columns are not those of bodies");
    for (auto const& row : json.at("states")) {
      std::vector<Quad> x;
      for (std::size_t i = 0; i < columns.size(); ++i)
        x.push_back(strtoflt128(row.at("hex").at(i).get<std::string>().c_str(), nullptr));
      c.times.push_back(row.at("t"));
      c.states.push_back(state_of(x, c.layout));
    }
    if (c.states.empty()) throw refuse("it has no states");
    return c;
  } catch (results::StoreError const& error) {
    throw ReferenceError(error.what());
  } catch (nlohmann::json::exception const& error) {
    throw refuse(error.what());
  } catch (std::invalid_argument const& error) {
    throw refuse(error.what());
  }
}

}  // namespace polhode::bench
