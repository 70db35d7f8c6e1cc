#pragma once

#include <set>
#include <string>

#include "services/common/log/log_file.hpp"
#include "tests/replay/replay_run.hpp"

namespace luminav {

/// The nodes that are asked for, or all for which the log has inputs. Throws std::runtime_error for a node without.
std::set<std::string> nodes_for(const ReplayOptions& options);

/// Decides which recorded inputs are fed; writes what is wrong with them into the report.
class ReplayInputs {
 public:
  /// `camera_shift` [m]: added to the recorded detections.
  ReplayInputs(double camera_shift, ReplayReport& report) : camera_shift_(camera_shift), report_(report) {}

  /// False for what must not be fed: another version of its type, commands that load or save files. Shifts detections.
  bool admit(LogEvent& event);

 private:
  [[nodiscard]] double elapsed(const LogEvent& event) const;
  bool is_of_our_version(const LogEvent& event);
  bool only_clears(const LogEvent& event);
  void note_robot(const LogEvent& event);
  void shift(LogEvent& event) const;

  double camera_shift_;
  ReplayReport& report_;
  std::set<std::string> foreign_;  // channels
  std::set<std::string> robots_;
};

}  // namespace luminav
