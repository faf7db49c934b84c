#include "bench/ensemble/dispersion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "bench/ensemble/philox.hpp"
#include "bench/process/text.hpp"

namespace polhode::bench {
namespace {

using Kind = Distribution::Kind;

struct Form {
  std::string_view name;
  Kind kind;
  std::size_t numbers;
  std::string_view usage;
};
constexpr std::array forms{
    Form{"normal", Kind::normal, 2, "normal(MEAN,SIGMA)"}, Form{"uniform", Kind::uniform, 2, "uniform(A,B)"},
    Form{"log_uniform", Kind::log_uniform, 2, "log_uniform(A,B)"}, Form{"so3", Kind::so3, 0, "so3()"}};

Form const& form_of(Kind kind) {
  return *std::ranges::find(forms, kind, &Form::kind);
}

/// One --disperse on its way; knows its own text for messages.
class Reader {
 public:
  Reader(ProblemWord const& problem, std::string const& text) : problem_(problem), text_(text) {}

  Dispersion read() const {
    auto const equals = text_.find('=');
    if (equals == std::string::npos || equals == 0) refuse("write NAME=DISTRIBUTION, e.g. omega0.x=normal(0.1,0.02)");
    Dispersion read;
    ParameterWord const& parameter = read_name(trimmed(std::string_view(text_).substr(0, equals)), read);
    read.distribution = read_distribution(trimmed(std::string_view(text_).substr(equals + 1)));
    check_attitude(read, parameter);
    std::string const name = read.component < 0 ? read.parameter
                                                : fmt::format("{}.{}", read.parameter,
                                                              component_name(parameter, std::size_t(read.component)));
    Distribution const& d = read.distribution;
    read.text = d.kind == Kind::so3 ? fmt::format("{}=so3()", name)
                                    : fmt::format("{}={}({},{})", name, form_of(d.kind).name, d.a, d.b);
    return read;
  }

 private:
  [[noreturn]] void refuse(std::string const& why) const {
    throw UsageError(fmt::format("--disperse {}: {}", quote(text_), why));
  }

  static std::string component_name(ParameterWord const& parameter, std::size_t i) {
    constexpr std::array letters{"x", "y", "z", "w"};
    return parameter.value.size() <= letters.size() ? letters[i] : std::to_string(i + 1);
  }
  ParameterWord const& read_name(std::string_view name, Dispersion& read) const {
    auto const dot = name.find('.');
    read.parameter = name.substr(0, dot);
    std::vector<std::string> known;
    for (ParameterWord const& word : problem_.parameters) known.push_back(word.name);
    auto const found = std::ranges::find(problem_.parameters, read.parameter, &ParameterWord::name);
    if (found == problem_.parameters.end()) refuse(unknown("parameter", read.parameter, known, "of " + problem_.name));
    refuse_structure(read.parameter);
    if (dot != std::string::npos) read.component = read_component(*found, name.substr(dot + 1));
    return *found;
  }
  /// What decides when things happen, or how many there are, is the same for all samples.
  void refuse_structure(std::string const& name) const {
    for (char const* period : {"sample_period", "delay", "t_f"})
      if (name == period) refuse(fmt::format("all samples keep the same times; change {} for all with --set", name));
    for (char const* shape : {"graph", "n", "seed"})
      if (name == shape)
        refuse(fmt::format("{} is no number that can be dispersed; change it for all with --set", name));
  }
  int read_component(ParameterWord const& parameter, std::string_view name) const {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < parameter.value.size(); ++i) known.push_back(component_name(parameter, i));
    if (known.size() == 1) refuse(fmt::format("{} is one number: write {}=...", parameter.name, parameter.name));
    for (std::size_t i = 0; i < known.size(); ++i)
      if (name == known[i] || name == std::to_string(i + 1)) return int(i);
    refuse(fmt::format("{} has no component {}; choose from {}", parameter.name, quote(name), fmt::join(known, ", ")));
  }

  Distribution read_distribution(std::string_view text) const {
    std::vector<std::string> usages, names;
    for (Form const& form : forms) {
      usages.emplace_back(form.usage);
      names.emplace_back(form.name);
    }
    auto const open = text.find('(');
    std::string_view const name = trimmed(text.substr(0, open));
    auto const* const form = std::ranges::find(forms, name, &Form::name);
    if (form == forms.end()) {
      std::string const near = nearest(name, names);
      refuse(fmt::format("unknown distribution {}; {}", quote(name),
                         near.empty()
                             ? fmt::format("choose from {}", fmt::join(usages, ", "))
                             : fmt::format("did you mean {}?", std::ranges::find(forms, near, &Form::name)->usage)));
    }
    if (open == std::string::npos || text.back() != ')') refuse(fmt::format("write {}", form->usage));
    std::vector<double> const numbers = read_numbers(text.substr(open + 1, text.size() - open - 2));
    if (numbers.size() != form->numbers)
      refuse(fmt::format("{} takes {} numbers, not {}: {}", name, form->numbers, numbers.size(), form->usage));
    Distribution read{.kind = form->kind};
    if (form->numbers == 2) read.a = numbers[0], read.b = numbers[1];
    check(read);
    return read;
  }
  std::vector<double> read_numbers(std::string_view text) const {
    std::vector<double> numbers;
    for (std::string_view const field : fields_of(text)) {
      auto const number = finite_number(field);
      if (!number) refuse(fmt::format("{} is not a finite number", quote(field)));
      numbers.push_back(*number);
    }
    return numbers;
  }
  void check(Distribution const& d) const {
    if (d.kind == Kind::normal && !(d.b > 0))
      refuse(fmt::format("sigma = {:g}: a standard deviation is greater than 0; --set keeps a number fixed", d.b));
    if (d.kind == Kind::uniform && !(d.a < d.b))
      refuse(fmt::format("from {:g} to {:g} there is nothing: give the lower end first", d.a, d.b));
    if (d.kind == Kind::log_uniform && !(0 < d.a && d.a < d.b))
      refuse(fmt::format("from {:g} to {:g}: a logarithm needs 0 < A < B", d.a, d.b));
  }
  void check_attitude(Dispersion const& read, ParameterWord const& parameter) const {
    bool const attitude = parameter.name == "q0", turned = read.distribution.kind == Kind::so3;
    if (turned && !attitude) refuse(fmt::format("so3() is a distribution of attitudes: write q0=so3()"));
    if (attitude && (!turned || read.component >= 0))
      refuse("components of a unit quaternion are not independent: write q0=so3()");
  }

  ProblemWord const& problem_;
  std::string const& text_;
};

/// FNV-1a, 32 bits: the parameter's place in the counter.
std::uint32_t number_of(std::string_view name) {
  std::uint32_t hash = 0x811C9DC5;
  for (char const c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x01000193;
  return hash;
}

/// The random words of one component of one parameter of one sample; `block` for more than four.
std::array<std::uint32_t, 4> words_of(std::uint64_t seed, std::int64_t sample, std::string_view parameter,
                                      std::size_t component, std::uint32_t block) {
  auto const k = std::uint64_t(sample);
  return philox4x32(
      {std::uint32_t(k), std::uint32_t(k >> 32), number_of(parameter), std::uint32_t(component) * 2 + block},
      {std::uint32_t(seed), std::uint32_t(seed >> 32)});
}

/// Source: Shoemake (1992), "Uniform random rotations", Graphics Gems III, p. 124. Scalar last.
std::vector<double> rotation_of(std::uint64_t seed, std::int64_t sample, std::string_view parameter) {
  auto const first = words_of(seed, sample, parameter, 0, 0), second = words_of(seed, sample, parameter, 0, 1);
  double const u = open_unit(first[0], first[1]);
  double const a = 2 * std::numbers::pi * open_unit(first[2], first[3]);
  double const b = 2 * std::numbers::pi * open_unit(second[0], second[1]);
  double const inner = std::sqrt(1 - u), outer = std::sqrt(u);
  return {inner * std::sin(a), inner * std::cos(a), outer * std::sin(b), outer * std::cos(b)};
}

/// Normal: Box & Muller (1958), one of the pair.
double number_in(Distribution const& d, std::array<std::uint32_t, 4> const& words) {
  double const u = open_unit(words[0], words[1]);
  switch (d.kind) {
    case Kind::normal: {
      double const turn = 2 * std::numbers::pi * open_unit(words[2], words[3]);
      return d.a + d.b * (std::sqrt(-2 * std::log(u)) * std::cos(turn));
    }
    case Kind::uniform:
      return d.a + (d.b - d.a) * u;
    case Kind::log_uniform:
      return d.a * std::exp(std::log(d.b / d.a) * u);
    default:
      return u;
  }
}

}  // namespace

Dispersions::Dispersions(ProblemWord const& problem, std::map<std::string, std::vector<double>> const& set,
                         std::vector<std::string> const& texts, std::uint64_t seed)
    : seed_(seed) {
  for (std::string const& text : texts) {
    Dispersion const read = Reader(problem, text).read();
    for (Dispersion const& other : list_)
      if (other.parameter == read.parameter &&
          (other.component < 0 || read.component < 0 || other.component == read.component))
        throw UsageError(fmt::format("--disperse {}: {} is dispersed already, by {}; give one", quote(text),
                                     read.parameter, quote(other.text)));
    bool const is_set = set.contains(read.parameter);
    auto const& own = std::ranges::find(problem.parameters, read.parameter, &ParameterWord::name)->value;
    std::vector<double> const& base = is_set ? set.at(read.parameter) : own;
    constexpr std::size_t most_of_one_body = 6;
    if (read.component >= 0 && !is_set && base.size() > most_of_one_body)
      throw UsageError(fmt::format("--disperse {}: the other numbers of {} follow from the variant: give them by --set",
                                   quote(text), read.parameter));
    if (is_set && read.component < 0)
      throw UsageError(fmt::format("--disperse {}: {} is given by --set, too; give one", quote(text), read.parameter));
    if (std::ranges::find(names_, read.parameter) == names_.end()) {
      names_.push_back(read.parameter);
      base_.push_back(base);
    }
    if (read.component >= int(base.size()))
      throw UsageError(fmt::format("--disperse {}: {} has {} numbers", quote(text), read.parameter, base.size()));
    list_.push_back(read);
  }
}

std::size_t Dispersions::place_of(std::string const& parameter) const {
  return std::size_t(std::ranges::find(names_, parameter) - names_.begin());
}

void Dispersions::draw(std::int64_t sample, std::vector<std::vector<double>>& values) const {
  values = base_;
  for (Dispersion const& each : list_) {
    std::vector<double>& numbers = values[place_of(each.parameter)];
    if (each.distribution.kind == Kind::so3) {
      numbers = rotation_of(seed_, sample, each.parameter);
      continue;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (each.component < 0 || each.component == int(i))
        numbers[i] = number_in(each.distribution, words_of(seed_, sample, each.parameter, i, 0));
  }
}

std::map<std::string, std::vector<double>> Dispersions::with_sample(std::map<std::string, std::vector<double>> set,
                                                                    std::int64_t sample) const {
  std::vector<std::vector<double>> values;
  draw(sample, values);
  for (std::size_t i = 0; i < names_.size(); ++i) set[names_[i]] = values[i];
  return set;
}

std::map<std::string, std::vector<double>> Dispersions::with_end(std::map<std::string, std::vector<double>> set,
                                                                 Dispersion const& of, bool upper) const {
  Distribution const& d = of.distribution;
  if (d.kind == Kind::so3) return set;
  std::vector<double> numbers = base_[place_of(of.parameter)];
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (of.component < 0 || of.component == int(i)) numbers[i] = d.kind != Kind::normal && upper ? d.b : d.a;
  set[of.parameter] = numbers;
  return set;
}

}  // namespace polhode::bench
