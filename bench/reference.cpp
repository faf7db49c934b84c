#include "bench/reference.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "problems/exact.hpp"

namespace polhode::bench {
namespace {

constexpr double tolerance = 1e-34;  // of the last terms: below the rounding of the sum

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
std::array<Quad, 7> numbers(QuadState const& s) {
  return {s.q.x, s.q.y, s.q.z, s.q.w, s.omega.x, s.omega.y, s.omega.z};
}

}  // namespace

Reference Reference::solve(ChosenProblem const& problem, Schedule const& schedule) {
  std::vector<Stop> const stops = stops_of(schedule);
  auto const field = problem.as_series();
  std::vector<Series> start(7);
  store(field->initial(), start.data());
  std::vector<Quad> state;
  for (Series const& component : start) state.push_back(component[0]);

  Reference reference;
  reference.t_end_ = schedule.t_end;
  auto const note_rate = [&] {
    Vec3<Quad> const omega{state[4], state[5], state[6]};
    reference.largest_rate_ = std::max(reference.largest_rate_, double(length(omega)));
  };
  note_rate();
  for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
    Quad t = stops[k].time;
    Quad const next = stops[k + 1].time;
    if (stops[k].sample) {
      std::vector<Series> const constants(state.begin(), state.end());
      Point<SeriesSpace> x;
      load(x, constants.data());
      field->sample(t, x);
    }
    if (stops[k].jump) field->enter_phase(t);
    while (t < next) {
      auto segment = expand<Quad, 32>(*field, state, t, Quad(next - t), tolerance);
      if (!(segment.h > 1e-9 * schedule.t_end) && !(segment.h >= next - t))
        throw ReferenceError(fmt::format("{}: the Taylor series has no useful radius of convergence at t = {} s",
                                         problem.info().name, double(t)));
      for (std::size_t i = 0; i < state.size(); ++i) state[i] = segment.component[i].at(segment.h);
      bool const arrived = segment.h >= next - t;
      t = arrived ? next : t + segment.h;
      reference.segments_.push_back(std::move(segment));
      note_rate();
    }
  }
  return reference;
}

QuadState Reference::at(double t) const {
  auto const after = std::upper_bound(segments_.begin(), segments_.end(), Quad(t),
                                      [](Quad time, auto const& segment) { return time < segment.t; });
  auto const& segment = after == segments_.begin() ? *after : *(after - 1);
  Quad const s = Quad(t) - segment.t;
  auto const value = [&](std::size_t i) { return segment.component[i].at(s); };
  return {{value(0), value(1), value(2), value(3)}, {value(4), value(5), value(6)}};
}

double angle_between(QuadState const& a, QuadState const& b) {
  return double(polhode::angle_between(a.q, b.q));
}

std::vector<QuadState> solve_by_gauss(ChosenProblem const& problem, Schedule const& schedule, int divisions) {
  std::vector<Stop> const stops = stops_of(schedule);
  auto const field = problem.in_quad();
  auto stepper = Gauss<8>{}.bind(*field, FixedStep{(stops[1].time - stops[0].time) / divisions}, NormPolicy::none);
  Point<QuadSpace> x = field->initial();
  std::vector<QuadState> states;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    if (stops[k].sample) field->sample(stops[k].time, x);
    if (stops[k].jump) field->enter_phase(stops[k].time);
    if (stops[k].sample || stops[k].jump) stepper.restart();
    states.push_back({x.first, x.second});
    if (k + 1 == stops.size()) break;
    if (stepper.advance(x, stops[k].time, stops[k + 1].time) != Status::ok)
      throw ReferenceError(
          fmt::format("{}: Gauss in quadruple precision diverged after t = {} s", problem.info().name, stops[k].time));
  }
  return states;
}

std::string reference_subject(results::Cell const& cell) {
  std::string text =
      fmt::format("problem={};variant={};t_end={:.17g};seed={}", cell.problem, cell.variant, cell.t_end, cell.seed);
  for (auto const& [name, values] : cell.set) text += fmt::format(";{}={:.17g}", name, fmt::join(values, ","));
  return text;
}

std::string reference_id(results::Cell const& cell) {
  return results::hash_of(reference_subject(cell));
}

namespace {

/// The closed form of a free body in principal axes; null for any other problem, and for initial data or signs that
/// belong to no physical body.
std::optional<ExactFreeBody<Quad>> closed_form_of(ChosenProblem const& problem) {
  BodyParameters const& body = problem.body();
  if (!problem.torque_free() || !body.principal() || body.coriolis_sign != 1 || body.raw_q0) return {};
  Vec3<Quad> const moments{body.inertia[0], body.inertia[1], body.inertia[2]};
  return ExactFreeBody<Quad>(moments, body.attitude<Quad>(), body.rate<Quad>());
}

}  // namespace

namespace {

constexpr double good_enough = 1e-28;  // [rad]; a reference may be worse, but then no finer step helps
constexpr int most_halvings = 7;

/// Empty if the method diverges: its fixed point needs h times the Lipschitz constant below 1.
std::vector<QuadState> try_gauss(ChosenProblem const& problem, Schedule const& schedule, int divisions) {
  try {
    return solve_by_gauss(problem, schedule, divisions);
  } catch (ReferenceError const&) {
    return {};
  }
}

/// The greatest distance of two solutions [rad]; infinite if one of them is missing.
double largest_angle(std::vector<QuadState> const& a, std::vector<QuadState> const& b) {
  if (a.empty() || b.empty()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, angle_between(a[k], b[k]));
  return largest;
}

}  // namespace

Certificate certify(results::Cell const& cell, ChosenProblem const& problem, Schedule const& schedule,
                    Reference const& reference) {
  Certificate certificate{.id = reference_id(cell), .subject = reference_subject(cell)};
  Schedule watched = schedule;
  if (!(watched.sample_period > 0)) watched.output_period = schedule.t_end / 100;
  std::vector<Stop> const stops = stops_of(watched);
  // A turn of 0.15 rad a step brings order 16 to 33 digits; stiff loops need smaller steps still.
  double const h = std::min(0.5, 0.15 / std::max(reference.largest_rate(), 1e-3));
  int divisions = int(std::ceil((stops[1].time - stops[0].time) / h - 1e-9));
  std::vector<QuadState> coarse = try_gauss(problem, watched, divisions),
                         fine = try_gauss(problem, watched, 2 * divisions);
  for (int halvings = 0; halvings < most_halvings && !(largest_angle(coarse, fine) < good_enough); ++halvings) {
    divisions *= 2;
    coarse = std::move(fine);
    fine = try_gauss(problem, watched, 2 * divisions);
  }
  if (fine.empty() || coarse.empty())
    throw ReferenceError(
        fmt::format("{}: Gauss in quadruple precision diverges at every step size tried; the problem is "
                    "too stiff for a certified reference",
                    problem.info().name));
  std::size_t const every = std::max<std::size_t>(1, (stops.size() - 1) / 50);
  for (std::size_t k = 0; k < stops.size(); ++k) {
    QuadState const here = reference.at(stops[k].time);
    certificate.disagreement = std::max(certificate.disagreement, angle_between(here, fine[k]));
    certificate.halving = std::max(certificate.halving, angle_between(coarse[k], fine[k]));
    if (k % every != 0 && k + 1 != stops.size()) continue;
    certificate.times.push_back(stops[k].time);
    certificate.states.push_back(here);
  }
  certificate.bar = std::max(certificate.disagreement, certificate.halving);
  if (auto const exact = closed_form_of(problem)) {
    double worst = 0;
    for (std::size_t k = 0; k < certificate.times.size(); ++k) {
      Quat<Quad> const q = exact->at(certificate.times[k]).first;
      worst = std::max(worst, double(polhode::angle_between(certificate.states[k].q, q)));
    }
    certificate.closed_form = worst;
    certificate.bar = std::max(certificate.bar, worst);
  }
  return certificate;
}

namespace {

constexpr std::array names{"q1", "q2", "q3", "q4", "wx", "wy", "wz"};

nlohmann::ordered_json contents_of(Certificate const& c) {
  std::vector<std::string> methods{"Taylor, degree 32, float128, flat quaternion", "Gauss, 8 stages, float128, S3"};
  nlohmann::ordered_json closed_form;  // null
  if (c.closed_form) {
    methods.emplace_back("closed form, elliptic functions, float128");
    closed_form = *c.closed_form;
  }
  nlohmann::ordered_json json{{"schema", results::schema},
                              {"kind", "reference"},
                              {"id", c.id},
                              {"subject", c.subject},
                              {"methods", methods},
                              {"bar_rad", c.bar},
                              {"disagreement_rad", c.disagreement},
                              {"halving_rad", c.halving},
                              {"closed_form_rad", closed_form},
                              {"columns", names}};
  for (std::size_t k = 0; k < c.times.size(); ++k) {
    nlohmann::ordered_json row{{"t", c.times[k]}};
    for (Quad x : numbers(c.states[k])) {
      row["decimal"].push_back(decimal(x));
      row["hex"].push_back(hexadecimal(x));
    }
    json["states"].push_back(row);
  }
  return json;
}

}  // namespace

void save(Certificate const& certificate, std::filesystem::path const& folder) {
  nlohmann::ordered_json json = contents_of(certificate);
  json["hash"] = results::hash_of(json.dump());
  std::filesystem::create_directories(folder);
  std::filesystem::path const file = folder / (certificate.id + ".json");
  std::ofstream out(file);
  out << json.dump(1) << '\n';
  if (!out.flush()) throw ReferenceError(file.string() + ": cannot be written");
}

Certificate load(std::filesystem::path const& file) {
  auto const refuse = [&](std::string const& why) {
    return ReferenceError(fmt::format("{}: {}; make it anew with `polhode reference`", file.string(), why));
  };
  try {
    std::ifstream in(file);
    if (!in) throw refuse("cannot be read");
    auto json = nlohmann::ordered_json::parse(in);
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
    for (auto const& row : json.at("states")) {
      std::array<Quad, 7> x{};
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = strtoflt128(row.at("hex").at(i).get<std::string>().c_str(), nullptr);
      c.times.push_back(row.at("t"));
      c.states.push_back({{x[0], x[1], x[2], x[3]}, {x[4], x[5], x[6]}});
    }
    return c;
  } catch (nlohmann::json::exception const& error) {
    throw refuse(error.what());
  }
}

void check_fresh(Certificate const& certificate, Reference const& reference, std::filesystem::path const& file) {
  // Round-off of two builds differs: a hundred units in the last place of quadruple precision are no disagreement.
  double const room = std::max(10 * certificate.bar, 1e-30);
  for (std::size_t k = 0; k < certificate.times.size(); ++k) {
    double const apart = angle_between(certificate.states[k], reference.at(certificate.times[k]));
    if (apart <= room) continue;
    throw ReferenceError(
        fmt::format("{}: stale: at t = {} s it is {:.1e} rad from the solution of today's problem; make "
                    "it anew with `polhode reference`",
                    file.string(), certificate.times[k], apart));
  }
}

std::shared_ptr<UsableReference const> obtain(results::Cell const& cell, ChosenProblem const& problem,
                                              Schedule const& schedule, std::filesystem::path const& folder) {
  auto usable = std::make_shared<UsableReference>();
  usable->id = reference_id(cell);
  usable->reference = Reference::solve(problem, schedule);
  std::filesystem::path const file = folder / (usable->id + ".json");
  if (std::filesystem::exists(file)) {
    Certificate const certificate = load(file);
    check_fresh(certificate, usable->reference, file);
    usable->bar = certificate.bar;
  } else {
    usable->bar = certify(cell, problem, schedule, usable->reference).bar;
  }
  return usable;
}

}  // namespace polhode::bench
