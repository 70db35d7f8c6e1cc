#pragma once

#include <string>
#include <vector>

#include "tests/evaluation/detector_score/detector_suite.hpp"
#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// `{"suite", "mode", "sensing", "summary", "runs"}` over many runs; "suites" and "scenarios" too where there are
/// several, with a summary of each; "detector" where its lighting matrix was measured.
std::string to_json(const std::string& suite, const std::string& mode, const std::string& sensing,
                    const std::vector<RunReport>& runs, const std::vector<DetectorCondition>& detector = {});
/// A line for each scenario, and for each suite where there are several.
std::string scenario_table_text(const std::vector<RunReport>& runs);
/// The summary of such a text as lines for people.
std::string summary_text(const std::string& json);

}  // namespace luminav
