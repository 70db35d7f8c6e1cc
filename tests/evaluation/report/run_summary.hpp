#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// Runs that are summed up together.
struct RunGroup {
  std::string suite;
  std::string name;  // of a scenario or of several that are alike; a whole suite has its own
  std::vector<const RunReport*> runs;

  [[nodiscard]] bool is_suite() const { return name == suite; }
};

/// What many runs came to together; a figure that none of them has is left out. Means over runs, but for what counts
/// goals or contacts.
nlohmann::ordered_json summary_of(const std::vector<const RunReport*>& runs);

/// All of them.
std::vector<const RunReport*> pointers_to(const std::vector<RunReport>& runs);
/// The runs by suite, in the order in which they came.
std::vector<RunGroup> suites_of(const std::vector<RunReport>& runs);
/// The runs by group, in the order in which they came.
std::vector<RunGroup> groups_of(const std::vector<RunReport>& runs);
/// Rows of a table: where there are several suites, each before its groups, if it has several.
std::vector<RunGroup> rows_of(const std::vector<RunReport>& runs);

}  // namespace luminav
