#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace luminav {

/// Runs of a report by scenario and seed.
using ReportRuns = std::map<std::pair<std::string, std::uint64_t>, nlohmann::json>;

/// Reads the text of `evaluate --json`. Throws std::runtime_error, which names the report as `which`, for text that is
/// none or that holds a run twice.
ReportRuns runs_of_report(const std::string& text, const std::string& which);
/// The same, and the conditions under which the detector alone was measured, as runs of "detector, CONDITION".
ReportRuns parts_of_report(const std::string& text, const std::string& which);

}  // namespace luminav
