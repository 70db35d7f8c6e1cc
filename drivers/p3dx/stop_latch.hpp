#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <utility>

namespace luminav {

/// The software stop: once engaged it stays until it is released. Requests are repeated by their senders and each is
/// acted on once; nobody's release from before a stop of his own counts. Survives a restart when it is given a folder.
class StopLatch {
 public:
  /// Reads the state from `folder`/stop; "" = none is kept.
  explicit StopLatch(std::filesystem::path folder = {});

  /// True when the request changed the state. Touches no disk: a stop must not wait for one.
  bool request(std::int64_t id, bool engaged, const std::string& sender);
  /// Writes what was requested since the last time, when the robot has been told.
  void save();
  [[nodiscard]] bool engaged() const { return engaged_; }
  /// Id of the last request acted on; 0 = none.
  [[nodiscard]] std::int64_t id() const { return id_; }
  [[nodiscard]] const std::string& sender() const { return sender_; }

 private:
  std::filesystem::path file_;
  bool engaged_ = false;
  bool kept_ = true;  // as it stands in the file
  std::int64_t id_ = 0;
  std::string sender_;
  std::deque<std::pair<std::string, std::int64_t>> seen_;  // sender and id, newest last
};

}  // namespace luminav
