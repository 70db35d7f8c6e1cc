#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace luminav {

/// While it lives, a share of the packets on a UDP port of this network is lost.
class PacketLoss {
 public:
  /// Throws std::runtime_error where it is not possible.
  PacketLoss(int port, int percent);
  ~PacketLoss();
  PacketLoss(const PacketLoss&) = delete;
  PacketLoss& operator=(const PacketLoss&) = delete;
  /// Only in a network namespace of its own, and with nft.
  static bool is_possible();
};

/// While it lives, so many processes per core compute for nothing.
class BusyLoops {
 public:
  explicit BusyLoops(int per_core);
  ~BusyLoops();
  BusyLoops(const BusyLoops&) = delete;
  BusyLoops& operator=(const BusyLoops&) = delete;

 private:
  std::vector<pid_t> processes_;
};

/// While it lives, nothing can be written to a folder. For a mount namespace of its own. Files that are open stay so.
class ReadOnlyFolder {
 public:
  /// Throws std::runtime_error where it is not possible.
  explicit ReadOnlyFolder(std::filesystem::path folder);
  ~ReadOnlyFolder();
  ReadOnlyFolder(const ReadOnlyFolder&) = delete;
  ReadOnlyFolder& operator=(const ReadOnlyFolder&) = delete;

 private:
  std::filesystem::path folder_;
};

/// A viewer that is told to stop the robot and killed right after. Its port is 18080.
class DoomedViewer {
 public:
  /// Starts it; throws std::runtime_error when it does not serve within ten seconds.
  explicit DoomedViewer(const std::vector<std::string>& command);
  ~DoomedViewer() { kill_it(); }
  DoomedViewer(const DoomedViewer&) = delete;
  DoomedViewer& operator=(const DoomedViewer&) = delete;

  /// As a page does; true when it has answered.
  bool stop_robot() const;
  void kill_it();

 private:
  pid_t process_ = -1;
};

/// The first child of a process; 0 = none.
pid_t child_of(pid_t process);

}  // namespace luminav
