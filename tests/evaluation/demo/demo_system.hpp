#pragma once

#include <sys/types.h>

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "drivers/simulator/world/scenario.hpp"
#include "services/launcher/pmd_file.hpp"
#include "services/launcher/sheriff/sheriff.hpp"

namespace luminav {

/// All processes of the demo: a deputy of its own, started as a child, and the sheriff that commands it. Nothing is
/// left behind when it is destroyed or when this process dies.
class DemoSystem {
 public:
  /// `mode` of all nodes that have two, "" = as the robot's file says; `log_file` "" = no recording.
  DemoSystem(const Scenario& scenario, const std::string& mode, const std::string& lcm_url,
             const std::string& log_file);
  ~DemoSystem();
  DemoSystem(const DemoSystem&) = delete;
  DemoSystem& operator=(const DemoSystem&) = delete;

  /// Starts everything and waits until it is ready, handling `data`'s messages meanwhile. False when interrupted or
  /// when something does not come up: then failure() says what.
  [[nodiscard]] bool start(lcm::LCM& data);
  /// Starts the page on this port and the next one.
  void start_viewer(const Scenario& scenario, const std::string& lcm_url, int port);
  /// False when what the demo itself started, deputy, recorder or page, has ended: then failure() says which and why.
  [[nodiscard]] bool is_whole();
  /// Handles what arrives within 20 ms.
  void pump(lcm::LCM& data);
  /// Stops everything, the controller first.
  void stop();
  void kill_process(const std::string& name);

  [[nodiscard]] const launcher::Sheriff& sheriff() const { return *sheriff_; }
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  void start_deputy(const std::string& procman_url);
  void start_recorder(const Scenario& scenario, const std::string& lcm_url, const std::string& log_file);
  [[nodiscard]] std::filesystem::path robot_file_in_mode(const std::filesystem::path& file,
                                                         const std::string& mode) const;
  [[nodiscard]] std::filesystem::path configuration_for(const std::string& base) const;
  [[nodiscard]] std::string last_words(const std::string& process) const;

  std::filesystem::path state_folder_;
  launcher::PmdFile configuration_;
  std::unique_ptr<lcm::LCM> procman_;
  std::unique_ptr<launcher::Sheriff> sheriff_;
  std::string failure_;
  pid_t deputy_ = -1;
  pid_t recorder_ = -1;
  pid_t viewer_ = -1;
};

}  // namespace luminav
