#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "tests/evaluation/run_report.hpp"

namespace luminav {

/// What many runs came to together; a figure that none of them has is left out. Means over runs, but for what counts
/// goals or contacts.
nlohmann::ordered_json summary_of(const std::vector<RunReport>& runs);

}  // namespace luminav
