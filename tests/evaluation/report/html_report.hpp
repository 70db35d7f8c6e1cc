#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

struct HtmlReportInput {
  std::string json;     // the whole report as `--json` writes it
  std::string remarks;  // plain text below the summary: agreement of the sensings, comparison with an older report
  double wall_s = 0.0;  // [s] that all of it took
};

/// One page that needs nothing else: summary, a table over the scenarios, failures with the command that runs them
/// again and their log, and for each failed run and the first few passed ones of each scenario the ways over the map
/// and the error over time. Draws in light and dark as the reader's system asks.
std::string html_report(const HtmlReportInput& input, const std::vector<RunReport>& runs);

}  // namespace luminav
