// For libFuzzer, which finds its own way through the code: one program for each reader, named by POLHODE_FUZZED.
// README.md says how to build and run them.
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(unsigned char const* data, std::size_t size) {
  static polhode::fuzz::Target const& reader = polhode::fuzz::target_named(POLHODE_FUZZED);
  reader.run(std::string(reinterpret_cast<char const*>(data), size));
  return 0;
}
