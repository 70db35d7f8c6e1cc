#pragma once

#include <string>

#include "drivers/simulator/world/scenario.hpp"
#include "tests/evaluation/runs/whole_robot.hpp"
#include "tests/evaluation/survey_score/survey_score.hpp"

namespace luminav {

struct ExploringOptions {
  WholeRobotOptions robot;   // with the survey's folder and kinds
  std::string picture_file;  // PNG of the true floor: what came to be known of it, the way, fixtures; "" = none
  bool trace = false;        // a line on stdout every ten simulated seconds
};

/// What the survey of a robot that explores by itself came to, by the truth.
struct ExploringResult {
  bool is_finished = false;  // it wrote the building by itself
  std::string sentence;      // that it said last
  double simulated = 0.0;    // [s]
  double driven = 0.0;       // [m]
  int contacts = 0;
  int hard_contacts = 0;     // with what sonar hardly hears
  double home = 0.0;         // [m] from where it began to where it ended
  double floor_share = 0.0;  // 0..1 of the floor that a disc of 0.25 m reaches: known as free or driven over
  int fixtures = 0;          // that hang in the building
  int found = 0;             // of these
  SurveyScore score;
  double cpu = 0.0;  // [s] of this thread; estimates have their own
};

/// Lets a robot explore and survey a scenario's building until it is finished or the scenario's time is over. The same
/// but for `cpu` each time.
ExploringResult run_exploring(const Scenario& scenario, const ExploringOptions& options);

std::string to_text(const ExploringResult& result);
/// The figures as JSON text: metres, seconds.
std::string to_json(const ExploringResult& result);

}  // namespace luminav
