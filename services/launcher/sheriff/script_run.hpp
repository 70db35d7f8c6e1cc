#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/launcher/pmd_file.hpp"
#include "services/launcher/sheriff/sheriff.hpp"

namespace luminav::launcher {

/// Carries out one script of a configuration. Unlike procman's, a wait has a time limit, "running" means ready, and a
/// process that fails ends the script.
class ScriptRun {
 public:
  enum class Progress { kGoingOn, kSucceeded, kFailed };

  /// `time_limit` [s] of each wait for a status. Throws ConfigurationError when there is no such script.
  ScriptRun(Sheriff& sheriff, const PmdFile& file, const std::string& script, double time_limit = 30.0);
  /// One start, stop, restart or wait, without a file.
  ScriptRun(Sheriff& sheriff, const Action& action, double time_limit = 30.0);

  /// Goes as far as it can without waiting; to be called after each tick of the sheriff.
  Progress step(std::int64_t steady_now);
  /// What it waits for, or why it failed.
  [[nodiscard]] const std::string& message() const { return message_; }
  /// Targets that this run has started so far.
  [[nodiscard]] const std::vector<Target>& started() const { return started_; }

 private:
  void append(const PmdFile& file, const Script& script);
  void begin(const Action& action, std::int64_t steady_now);
  [[nodiscard]] Progress wait(const Action& action, std::int64_t steady_now);
  [[nodiscard]] Progress wait_for_status(const Action& action, std::int64_t steady_now);

  Sheriff& sheriff_;
  std::vector<Action> actions_;  // run_script replaced by what it runs
  std::size_t next_ = 0;
  std::optional<std::int64_t> begun_;  // [us] steady, of the action `next_`
  std::int64_t time_limit_;            // [us]
  std::string message_;
  std::vector<Target> started_;
};

}  // namespace luminav::launcher
