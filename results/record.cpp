#include "results/record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <istream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace polhode::results {
namespace {

constexpr std::array<std::pair<Status, std::string_view>, 10> status_names{{
    {Status::ok, "ok"},
    {Status::inaccurate, "inaccurate"},
    {Status::diverged, "diverged"},
    {Status::step_underflow, "step_underflow"},
    {Status::max_steps, "max_steps"},
    {Status::nonlinear_fail, "nonlinear_fail"},
    {Status::stalled, "stalled"},
    {Status::timeout, "timeout"},
    {Status::crashed, "crashed"},
    {Status::refused, "refused"},
}};

// --- Canonical text --------------------------------------------------------------------------------------------------

/// Quoted, so that no text can pass for the next member.
std::string canonical(std::string const& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string canonical(std::int64_t number) {
  return fmt::format("{}", number);
}

std::string canonical(double number) {
  if (!std::isfinite(number)) return "null";
  return fmt::format("{:.17g}", number);
}

std::string canonical(std::optional<double> const& number) {
  if (!number) return "null";
  return canonical(*number);
}

std::string canonical(std::map<std::string, std::vector<double>> const& set) {
  std::string text = "{";
  for (auto const& [name, numbers] : set) {
    text += canonical(name) + ":[";
    for (double const number : numbers) text += canonical(number) + ",";
    text += "],";
  }
  return text + "}";
}

/// Fowler, Noll and Vo's hash of 64 bits, as it goes.
class Fnv1a {
 public:
  void take(std::string_view text) {
    for (char const c : text) {
      state_ ^= static_cast<unsigned char>(c);
      state_ *= 0x100000001b3;
    }
  }
  std::string digits() const { return fmt::format("{:016x}", state_); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

}  // namespace

std::string_view name_of(Status status) {
  for (auto const& [known, name] : status_names) {
    if (known == status) return name;
  }
  throw std::invalid_argument(fmt::format("status: no status has the number {}", static_cast<int>(status)));
}

Status status_of(std::string_view name) {
  std::vector<std::string_view> names;
  for (auto const& [status, known] : status_names) {
    if (known == name) return status;
    names.push_back(known);
  }
  throw std::invalid_argument(fmt::format("status: \"{}\"; must be one of {}", name, fmt::join(names, ", ")));
}

std::string canonical_text(Cell const& cell) {
  std::string text;
  for_each_cell_field(cell, [&](std::string_view name, std::string_view, auto const& member) {
    text += fmt::format("{}={}\n", name, canonical(member));
  });
  return text;
}

std::string hash_of(std::string_view text) {
  Fnv1a hash;
  hash.take(text);
  return hash.digits();
}

std::string hash_of(std::istream& in) {
  Fnv1a hash;
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), std::ssize(block)), in.gcount() > 0) hash.take({block.data(), std::size_t(in.gcount())});
  return hash.digits();
}

std::string cell_id(Cell const& cell) {
  return hash_of(canonical_text(cell));
}

}  // namespace polhode::results
