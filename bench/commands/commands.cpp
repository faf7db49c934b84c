#include "bench/commands/commands.hpp"

#include <cstdio>

#include "results/whole_file.hpp"

namespace polhode::bench {

void write_out(std::string const& file, std::string_view text) {
  if (file.empty())
    std::fwrite(text.data(), 1, text.size(), stdout);
  else
    results::write_text(file, text);
}

void add_commands(CLI::App& app, int& code, Faces const& faces) {
  add_list(app);
  add_run(app, code);
  add_simulate(app, code, faces.plot);
  add_ensemble(app, code);
  add_reference(app);
  add_check(app, code);
  add_compare(app, code, faces.comparison);
  add_export(app);
  add_import(app);
  add_doctor(app);
}

}  // namespace polhode::bench
