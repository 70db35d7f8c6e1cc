#include "tests/evaluation/report_runs.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace luminav {

ReportRuns runs_of_report(const std::string& text, const std::string& which) {
  try {
    ReportRuns runs;
    const nlohmann::json all = nlohmann::json::parse(text);
    for (const nlohmann::json& run : all.at("runs")) {
      runs[{run.at("scenario"), run.at("seed")}] = run;
    }
    return runs;
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(fmt::format("{} report: not a report of evaluate: {}", which, error.what()));
  }
}

}  // namespace luminav
