#include "bench/process/additions.hpp"

namespace polhode::bench {

// For programs without a catalogue, such as tests of the readers; that of a catalogue_unit.cpp takes its place.
[[gnu::weak]] Additions const& additions() {
  static Additions const none;
  return none;
}

}  // namespace polhode::bench
