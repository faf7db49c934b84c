/// What one binary knows: Polhode's catalogues, and behind them what the binary adds. POLHODE_ADDITIONS is a header
/// that polhode_add_binary() writes (bench/cmake/PolhodeUnits.cmake):
///   AddedLists     the list of its integrators, by name alone, if there are any
///   AddedProblems  its problems
///   AddedRaces     the problems on which its integrators are timed as typed code
///   added_data     share/polhode of the Polhode that it was built against
#include <set>
#include <stdexcept>
#include <tuple>

#include "bench/process/additions.hpp"
#include "bench/solve/problems.hpp"
#include "problems/catalog.hpp"
#include POLHODE_ADDITIONS

namespace polhode::bench {
namespace {

template <class... D>
constexpr bool have_races(Types<D...>) {
  return (is_one_of<D>(RacedProblems{}) && ...);
}
static_assert(have_races(AddedRaces{}), "RACES: methods are raced on RacedProblems of problems/catalog.hpp alone");

template <class... D>
std::vector<ProblemEntry const*> entries(Types<D...>) {
  return {&problem_entry<D>()...};
}
template <Space M, class... List>
std::vector<MethodOn<M>> methods(Types<List...>) {
  std::vector<MethodOn<M>> all;
  [[maybe_unused]] auto const append = [&](std::vector<MethodOn<M>> const& list) {
    all.insert(all.end(), list.begin(), list.end());
  };
  (append(methods_on<M, List>()), ...);
  return all;
}

using Names = std::vector<std::string_view>;
Names names_of(std::vector<ProblemEntry const*> const& problems) {
  Names names;
  for (ProblemEntry const* entry : problems) names.push_back(entry->info().name);
  return names;
}
template <Space M>
Names names_of(std::vector<MethodOn<M>> const& methods) {
  Names names;
  for (MethodOn<M> const& method : methods) names.push_back(method.info->name);
  return names;
}
/// Of two entries that share a name only the first would ever run. Throws std::logic_error.
void check_that_they_differ(char const* kind, Names const& names) {
  std::set<std::string_view> seen;
  for (std::string_view const name : names)
    if (!seen.insert(name).second)
      throw std::logic_error("two " + std::string(kind) + " are called " + std::string(name) + "; rename one");
}
using FirstSpace = RigidBody<FlatQuaternion<double>>;  // on each the names are the same

}  // namespace

std::vector<ProblemEntry const*> const& all_problems() {
  static auto const all = [] {
    auto list = entries(Joined<Problems, AddedProblems>{});
    check_that_they_differ("problems", names_of(list));
    return list;
  }();
  return all;
}

template <Space M>
std::vector<MethodOn<M>> const& all_methods_on() {
  static auto const all = [] {
    auto list = methods<M>(Joined<MethodLists, AddedLists>{});
    if constexpr (std::same_as<M, FirstSpace>) check_that_they_differ("integrators", names_of(list));
    return list;
  }();
  return all;
}

template <Definition D>
std::unique_ptr<TimedSolve> raced_solve([[maybe_unused]] D const& definition,
                                        [[maybe_unused]] std::string_view formulation,
                                        [[maybe_unused]] std::string_view integrator,
                                        [[maybe_unused]] Plan const& plan) {
  std::unique_ptr<TimedSolve> found;
  [&]<class... List>(Types<List...>) {
    ((found || (found = timed_solve<D, List>(definition, formulation, integrator, plan))) || ...);
  }(std::conditional_t<is_one_of<D>(AddedRaces{}), Joined<RaceLists, AddedLists>, RaceLists>{});
  return found;
}

Additions const& additions() {
  static Additions const added{.integrators = names_of(methods<FirstSpace>(AddedLists{})),
                               .problems = names_of(entries(AddedProblems{})),
                               .data = added_data};
  return added;
}

namespace {

// Their addresses, kept, make an instance for every space, and for every problem that has races.
template <class... M>
auto methods_on_every_space(Types<M...>) {
  return std::tuple{&all_methods_on<M>...};
}
[[gnu::used]] auto const kept_methods =
    methods_on_every_space(Joined<OneBodySpaces, AttitudesSpaces, BodiesSpaces, PositionSpaces>{});
#ifdef POLHODE_RACES
template <class... D>
auto races(Types<D...>) {
  return std::tuple{&raced_solve<D>...};
}
[[gnu::used]] auto const kept_races = races(RacedProblems{});
#endif

}  // namespace
}  // namespace polhode::bench
