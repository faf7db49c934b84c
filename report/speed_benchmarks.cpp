#include "report/speed.hpp"
#include "report/text.hpp"

namespace polhode::report {

void add_benchmarks(Document& document, Facts const& facts) {
  if (facts.contents.benchmarks.all.empty()) {
    document.say(Text({{"The folder holds no figures of steps, ensembles and networks; "},
                       {"polhode-bench --out DIR", true},
                       {" adds them."}}));
    return;
  }
}

}  // namespace polhode::report
