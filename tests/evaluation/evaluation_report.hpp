#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/evaluation/detector_suite.hpp"
#include "tests/evaluation/run_report.hpp"

namespace luminav {

/// `{"suite", "mode", "sensing", "summary", "runs"}` over many runs; "detector" too where its lighting matrix was
/// measured.
std::string to_json(const std::string& suite, const std::string& mode, const std::string& sensing,
                    const std::vector<RunReport>& runs, const std::vector<DetectorCondition>& detector = {});
/// A line for each scenario.
std::string scenario_table_text(const std::vector<RunReport>& runs);
/// The summary of such a text as lines for people.
std::string summary_text(const std::string& json);
/// Runs of each scenario, in the order in which they came.
std::vector<std::pair<std::string, std::vector<RunReport>>> by_scenario(const std::vector<RunReport>& runs);

}  // namespace luminav
