#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <luminav_procman/procman_output_t.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "services/launcher/deputy/output_pacer.hpp"
#include "services/launcher/deputy/rotating_log.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {

/// What a deputy has to say and what its children print: for PM_OUTPUT, in log files, and to the person at its
/// terminal.
class DeputyJournal {
 public:
  /// No files without a `folder`.
  DeputyJournal(std::filesystem::path folder, const RotatingLogParams& log, const OutputPacerParams& output);

  /// What a person at the terminal should see.
  void report_notices(std::function<void(const std::string&)> notice) { notice_ = std::move(notice); }
  void say(const Instant& now, const std::string& sentence);
  /// At most one such sentence a second: for what somebody on the network may repeat without end.
  void say_seldom(const Instant& now, const std::string& sentence);

  /// The log file of a command; none without a folder.
  [[nodiscard]] std::unique_ptr<RotatingLog> open_log(const std::string& command_id) const;
  /// What a child printed. `log` may be null.
  void add_output(const Instant& now, const std::string& command_id, std::string_view text, RotatingLog* log);
  /// A line of the deputy's own in a command's log, which may be null.
  static void note(const Instant& now, const std::string& what, RotatingLog* log);

  /// All that is to be sent, without the deputy's name.
  [[nodiscard]] std::vector<luminav_procman::procman_output_t> take_output(const Instant& now);

 private:
  std::filesystem::path folder_;
  RotatingLogParams log_params_;
  OutputPacer output_;
  std::unique_ptr<RotatingLog> log_;  // deputy.log
  std::function<void(const std::string&)> notice_ = [](const std::string&) {};
  bool log_failed_ = false;
  std::int64_t last_seldom_at_ = 0;  // [us] steady
};

}  // namespace luminav::launcher
