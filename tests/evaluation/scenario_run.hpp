#pragma once

#include <functional>
#include <string>

#include "drivers/simulator/scenario.hpp"
#include "tests/evaluation/run_report.hpp"
#include "tests/evaluation/whole_robot.hpp"

namespace luminav {

struct ScenarioRunOptions {
  WholeRobotOptions robot;
  std::string log_file;      // LCM log of all channels; "" = none
  std::string picture_file;  // PNG of the run; "" = none
  bool trace = false;        // a line on stdout for each simulated second
};

/// Runs a scenario in process and in simulated time to its end and reports. Deterministic but for `wall_s`.
RunReport run_scenario(const Scenario& scenario, const ScenarioRunOptions& options);

/// Adds what depends on the mission (passed, failure, path efficiency) to the judge's report.
class RunJudge;
class Mission;
RunReport conclude(const RunJudge& judge, const Mission& mission, const WorldTruth& world);

}  // namespace luminav
