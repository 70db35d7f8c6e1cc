#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/launcher/sheriff/script_run.hpp"
#include "services/launcher/sheriff/sheriff.hpp"

namespace luminav::launcher {

/// A person's session with a sheriff at a terminal: pumps messages and ticks, shows the table, minds Ctrl-C.
class Session {
 public:
  Session(lcm::LCM& procman, lcm::LCM* data, Sheriff& sheriff);

  /// Runs until `done` or Ctrl-C; false for Ctrl-C. `show` keeps the table on the screen, or prints changes as lines
  /// when the output is no terminal.
  bool run_until(const std::function<bool()>& done, bool show);
  /// Waits [s]; false for Ctrl-C.
  bool run_for(double seconds, bool show = false);
  /// Runs a script to its end; nothing for Ctrl-C.
  std::optional<bool> run_script(ScriptRun& script, bool show);
  /// A line that stays, above the table.
  void print(const std::string& line);
  void show_table();

 private:
  void pump();
  void print_changes();
  void erase_table();

  lcm::LCM& procman_;
  lcm::LCM* data_;
  Sheriff& sheriff_;
  bool terminal_;
  std::size_t lines_on_screen_ = 0;
  std::int64_t shown_ = 0;                                 // [us] steady
  std::vector<std::pair<std::string, std::string>> last_;  // of each command, for changes as lines
};

}  // namespace luminav::launcher
