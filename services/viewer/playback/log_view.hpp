#pragma once

#include <atomic>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <string>

#include "services/common/process/clock.hpp"
#include "services/viewer/helm.hpp"
#include "services/viewer/http/metrics.hpp"
#include "services/viewer/picture_store.hpp"
#include "services/viewer/playback/log_player.hpp"
#include "services/viewer/request_desk.hpp"
#include "services/viewer/snapshot_board.hpp"
#include "services/viewer/viewer_config.hpp"
#include "services/viewer/viewer_node.hpp"

namespace luminav {

/// Shows a recorded log as a ViewerNode shows a running robot, by the log's own time, on a network inside this program:
/// nothing of it reaches any robot.
class LogView {
 public:
  /// Throws std::runtime_error for a file that is no log.
  LogView(const std::string& log, const ViewerConfig& config, SnapshotBoard& board, PictureStore& pictures);

  /// `elapsed` [us] have passed: puts the state on the board and wakes the readers.
  void advance(std::int64_t elapsed);
  /// A second has passed.
  void show_processes();

  [[nodiscard]] LogPlayer& player() { return player_; }
  [[nodiscard]] RequestDesk& desk() { return desk_; }
  [[nodiscard]] Helm& helm() { return helm_; }
  [[nodiscard]] const Clock& clock() const { return clock_; }
  [[nodiscard]] Health health() const { return node_->health(); }

 private:
  /// The time at which the log is.
  class LogClock final : public Clock {
   public:
    [[nodiscard]] std::int64_t utime() const override { return now_; }
    void set(std::int64_t now) { now_ = now; }

   private:
    std::atomic<std::int64_t> now_ = 0;  // [us]; threads that serve read it
  };
  void start_anew();
  void feed(const LogEvent& event, std::int64_t at);

  ViewerConfig config_;
  SnapshotBoard& board_;
  PictureStore& pictures_;
  lcm::LCM lcm_{"memq://"};
  LogPlayer player_;
  LogClock clock_;
  RequestDesk desk_;
  Helm helm_;
  std::optional<ViewerNode> node_;
  std::optional<Metrics> metrics_;
};

}  // namespace luminav
