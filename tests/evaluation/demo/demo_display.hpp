#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/hypotheses_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/launcher/sheriff/tracked_command.hpp"
#include "tests/evaluation/judge/run_judge.hpp"
#include "tests/evaluation/runs/mission.hpp"

namespace luminav {

/// Shows a run while it goes on: what the robot believes, how far that is from the truth, what it is doing and how each
/// process is. In place on a terminal, else a line every five seconds and at every change of state.
class DemoDisplay {
 public:
  DemoDisplay(lcm::LCM& lcm, const RunJudge& judge, const Mission& mission, const Scenario& scenario, bool headless);

  /// Shows what is due; cheap when nothing is.
  void update(const std::vector<launcher::CommandState>& processes);
  /// The last state stays on the screen.
  void finish();

 private:
  void on_hypotheses(const hypotheses_t& message) { hypotheses_ = message.count; }
  [[nodiscard]] std::vector<std::string> picture(const std::vector<launcher::CommandState>& processes) const;
  [[nodiscard]] std::string line(const std::vector<launcher::CommandState>& processes) const;
  [[nodiscard]] std::string belief() const;
  [[nodiscard]] std::string goal() const;

  const RunJudge& judge_;
  const Mission& mission_;
  const Scenario& scenario_;
  bool in_place_;
  Subscriber subscriber_;
  int hypotheses_ = 0;
  std::size_t lines_on_screen_ = 0;
  double shown_at_ = -1e9;  // [s] of the run
  std::string shown_state_;
};

}  // namespace luminav
