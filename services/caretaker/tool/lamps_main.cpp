// Says which lamps of a building are dark, partly dark or flicker: what scripts/lamps runs.

#include <fmt/format.h>

#include <string>

#include "services/caretaker/lamp_report.hpp"
#include "services/caretaker/tool/report_source.hpp"
#include "services/common/configuration/whole_file.hpp"

int main(int argc, char** argv) {
  luminav::ReportSource source;
  std::string csv, html, json;
  luminav::CommandLine line("lamps", "Says which lamps are dark, partly dark or flicker, by what the robot saw.");
  source.add_options(line);
  line.output_file("--csv", csv, "write a line for each fixture there")
      .output_file("--html", html, "write a page there")
      .output_file("--json", json, "write all findings there");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("lamps", [&] {
    const luminav::CeilingRecord record = luminav::read_record(source);
    const auto findings = luminav::judge_lamps(record.ledger, record.building.fixtures);
    if (!csv.empty()) {
      luminav::write_whole_file(csv, luminav::lamps_csv(findings, record.building));
    }
    if (!html.empty()) {
      luminav::write_whole_file(html, luminav::lamps_html(findings, record.building));
    }
    if (!json.empty()) {
      luminav::write_whole_file(json, luminav::lamps_json(findings, record.building));
    }
    fmt::print("{}", luminav::lamps_text(findings, record.building));
    return 0;
  });
}
