#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>

#include "services/launcher/pmd_file.hpp"
#include "tests/system/faults/hosts/network_host.hpp"

namespace luminav {

/// A machine of a test: a deputy with an environment, a state folder and perhaps a network of its own.
class TestHost {
 public:
  struct Setup {
    std::string id;
    const NetworkHost* network = nullptr;  // null = this one
    std::filesystem::path folder;          // state, logs and configuration; made if missing
    std::string procman_url;
    std::map<std::string, std::string> environment;
    int memory_limit = 1000;  // [MB] of a process
  };

  /// `commands`: what this machine may run, whatever deputy they name.
  TestHost(Setup setup, const launcher::PmdFile& commands);
  TestHost(const TestHost&) = delete;
  TestHost& operator=(const TestHost&) = delete;
  ~TestHost();

  void start();
  /// As a crash of the deputy: SIGKILL.
  void kill_deputy();
  /// Asks the deputy to end and waits until it has.
  void stop();
  [[nodiscard]] pid_t deputy() const { return deputy_; }
  [[nodiscard]] const std::string& id() const { return setup_.id; }
  [[nodiscard]] const std::filesystem::path& folder() const { return setup_.folder; }

 private:
  Setup setup_;
  pid_t deputy_ = -1;
};

/// Folder of this program, where the others are, too.
std::filesystem::path program_folder();

}  // namespace luminav
