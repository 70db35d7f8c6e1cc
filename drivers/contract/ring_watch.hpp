#pragma once

#include <cstdint>
#include <luminav/sonar_t.hpp>
#include <vector>

#include "drivers/contract/clause.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Holds SONAR against the discs of the robot's file.
class RingWatch {
 public:
  explicit RingWatch(const SonarRing& ring) : ring_(ring), utime_(ring.robot_from_sonar.size(), 0) {}

  void hear(const sonar_t& message);
  /// None for a base without discs.
  [[nodiscard]] std::vector<Clause> clauses() const;

 private:
  void judge_disc(const sonar_t& message, std::size_t disc);

  SonarRing ring_;
  std::vector<std::int64_t> utime_;  // [us] last firing, by disc
  Clause discs_{"SONAR: the discs of the robot's file, each with its range"};
  Clause ranges_{"SONAR: ranges within the ring's, the maximum where nothing echoed"};
  Clause firings_{"SONAR: each range with its own time; fresh where it fired since the last message"};
};

}  // namespace luminav
