#include "tests/evaluation/report/report_runs.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace luminav {

ReportRuns runs_of_report(const std::string& text, const std::string& which) {
  try {
    ReportRuns runs;
    const nlohmann::json all = nlohmann::json::parse(text);
    for (const nlohmann::json& run : all.at("runs")) {
      const auto [known, is_new] = runs.emplace(ReportRuns::key_type{run.at("scenario"), run.at("seed")}, run);
      if (!is_new) {
        throw std::runtime_error(fmt::format("{} report: holds {} seed {} twice, nobody can say which is meant", which,
                                             known->first.first, known->first.second));
      }
    }
    return runs;
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(fmt::format("{} report: not a report of evaluate: {}", which, error.what()));
  }
}

ReportRuns parts_of_report(const std::string& text, const std::string& which) {
  ReportRuns parts = runs_of_report(text, which);
  try {
    for (const nlohmann::json& condition : nlohmann::json::parse(text).value("detector", nlohmann::json::array())) {
      parts.emplace(ReportRuns::key_type{"detector, " + condition.at("condition").get<std::string>(), 0}, condition);
    }
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(fmt::format("{} report: not a report of evaluate: {}", which, error.what()));
  }
  return parts;
}

}  // namespace luminav
