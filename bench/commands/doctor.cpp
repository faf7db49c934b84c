/// The verb doctor: what is built in, and whether this machine is fit to take times on.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/process/doctor.hpp"

namespace polhode::bench {

void add_doctor(CLI::App& app) {
  auto const as_json = std::make_shared<bool>(false);
  CLI::App* verb = app.add_subcommand("doctor", "Say what is built in, and whether this machine is fit to time on");
  verb->add_flag("--json", *as_json, "As JSON");
  verb->callback([=] {
    std::vector<Finding> findings = what_is_built();
    for (Finding& finding : machine_state("/")) findings.push_back(std::move(finding));
    findings.push_back(timer_finding(timer_quality()));
    std::string const text = *as_json ? diagnosis_json(findings) : diagnosis_text(findings);
    std::fwrite(text.data(), 1, text.size(), stdout);
  });
}

}  // namespace polhode::bench
