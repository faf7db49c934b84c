#include "report/report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <vector>

#include "report/render/latex.hpp"
#include "report/render/render.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

Document document_of(Facts const& facts) {
  Document document{.title = "Polhode: report"};
  document.say(
      Text({{fmt::format("Made from {} alone by ", counted(facts.runs.size(), "record", "records"))},
            {"polhode report DIR", true},
            {", DIR being the folder of results. Angles are in radians unless said otherwise, times in seconds."}}));
  add_answer(document, facts);
  add_drift(document, facts);
  add_kept(document, facts);
  add_work_precision(document, facts);
  add_control_cases(document, facts);
  add_claims(document, facts);
  add_erratum(document, facts);
  add_sample_period(document, facts);
  add_sync(document, facts);
  add_consensus(document, facts);
  add_dead_zone(document, facts);
  add_so3(document, facts);
  add_classics(document, facts);
  add_constrained(document, facts);
  add_integrators(document, facts);
  add_orders(document, facts);
  add_speed(document, facts);
  add_ensembles(document, facts);
  add_failures(document, facts);
  add_references(document, facts);
  add_provenance(document, facts);
  return document;
}

void write(std::filesystem::path const& file, std::string const& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw ReportError(fmt::format("{}: cannot be written", file.string()));
}

void make_folder(std::filesystem::path const& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw ReportError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

}  // namespace

void write_report(results::Contents const& contents, std::filesystem::path const& out) {
  Facts const facts(contents);
  Document document = document_of(facts);
  make_folder(out / "tables");
  make_folder(out / "figures");
  std::vector<Figure*> figures;
  for (Block& block : document.blocks) {
    if (auto const* table = std::get_if<Table>(&block)) {
      write(out / "tables" / (table->name + ".csv"), to_csv(*table));
      write(out / "tables" / (table->name + ".tex"), to_latex(*table));
    }
    if (auto* figure = std::get_if<Figure>(&block)) {
      write(out / "figures" / (figure->name + ".csv"), to_csv(*figure));
      figures.push_back(figure);
    }
  }
  draw_all(figures, out / "figures");
  write(out / "report.md", to_markdown(document));
  write(out / "report.html", to_html(document, interactive_part(facts, page_assets())));
}

}  // namespace polhode::report
