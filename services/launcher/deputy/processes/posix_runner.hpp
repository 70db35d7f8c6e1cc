#pragma once

#include <filesystem>
#include <map>
#include <set>

#include "services/launcher/deputy/processes/orphan_guard.hpp"
#include "services/launcher/deputy/processes/process_runner.hpp"

namespace luminav::launcher {

/// Runs real children: each in a session and process group of its own behind a terminal (so that their output comes
/// line by line), with clean signal state, and never outliving the deputy. To be made before any thread is.
class PosixRunner final : public ProcessRunner {
 public:
  /// `program_folder` is put in front of the children's PATH.
  explicit PosixRunner(std::filesystem::path program_folder);
  /// Kills what still runs.
  ~PosixRunner() override;

  int start(const CommandWords& command) override;
  void signal(int pid, int signal) override;
  std::vector<ProcessOutput> take_output() override;
  std::vector<ProcessExit> take_exits() override;
  [[nodiscard]] ProcessUsage usage(int pid) override;
  [[nodiscard]] MachineUsage machine() override;
  [[nodiscard]] int processors() const override;

  /// Can be read (poll) when a child printed or ended.
  [[nodiscard]] int event_descriptor() const { return epoll_; }

 private:
  struct Child {
    int terminal = -1;  // our end
    int pidfd = -1;
    std::set<int> descendants;  // seen so far
  };
  void read_terminal(int pid, Child& child, std::vector<ProcessOutput>& outputs);
  void end_left_behind(int pid, const Child& child);
  void kill_lingering();
  [[nodiscard]] bool is_orphan_of_ours(int pid) const;
  void close_child(Child& child);

  OrphanGuard guard_;
  std::filesystem::path program_folder_;
  int epoll_ = -1;
  std::map<int, Child> children_;          // by pid
  std::map<int, std::int64_t> lingering_;  // descendants in a session of their own -> when they are killed, [us] steady
  std::vector<ProcessOutput> last_words_;  // read when a child ended
};

}  // namespace luminav::launcher
