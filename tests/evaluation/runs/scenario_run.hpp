#pragma once

#include <functional>
#include <string>

#include "drivers/simulator/world/scenario.hpp"
#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/runs/whole_robot.hpp"

namespace luminav {

struct SensingSurveyResult;

struct ScenarioRunOptions {
  WholeRobotOptions robot;
  std::string log_file;                   // LCM log of all channels; "" = none
  std::string picture_file;               // PNG of the run; "" = none
  bool patrol = false;                    // goals over and over until the duration is over
  bool trace = false;                     // a line on stdout for each simulated second
  SensingSurveyResult* survey = nullptr;  // what the detector did beside the truth is noted here
};

/// Runs a scenario in process and in simulated time to its end and reports. Deterministic but for `wall_s`,
/// `cpu_s` and `worst_step_ms`.
RunReport run_scenario(const Scenario& scenario, const ScenarioRunOptions& options);

/// Adds what depends on the mission (passed, failure, path efficiency) to the judge's report.
class RunJudge;
class Mission;
RunReport conclude(const RunJudge& judge, const Mission& mission, const WorldTruth& world);

}  // namespace luminav
