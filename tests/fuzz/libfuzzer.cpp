// For libFuzzer, which finds its own way through the code; tests/README.md says how it is built. $POLHODE_FUZZ names
// the target: suite, records, trajectory or graph.
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(unsigned char const* data, std::size_t size) {
  static polhode::fuzz::Target const* const chosen = [] {
    char const* name = std::getenv("POLHODE_FUZZ");
    for (polhode::fuzz::Target const& target : polhode::fuzz::targets)
      if (name != nullptr && target.name == name) return &target;
    std::fputs("POLHODE_FUZZ must be suite, records, trajectory or graph\n", stderr);
    std::exit(2);
  }();
  chosen->run(std::string(reinterpret_cast<char const*>(data), size));
  return 0;
}
