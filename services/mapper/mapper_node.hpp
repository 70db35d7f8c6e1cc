#pragma once

#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/tile_request_t.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/common/process/event_loop.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/mapper/grid_mapper.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/pose_history.hpp"
#include "services/mapper/tile_sender.hpp"

namespace luminav {

/// POSE and SONAR in, GRID_TILE out: draws each reading once, at the pose of its own instant, while the pose is good.
class MapperNode {
 public:
  /// With a key, commands without its seal are dropped.
  MapperNode(lcm::LCM& lcm, const MapperConfig& config, std::optional<CommandKey> key = {});

  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }
  [[nodiscard]] const OccupancyGrid& grid() const { return mapper_->grid(); }
  /// Readings drawn so far.
  [[nodiscard]] std::int64_t integrated() const { return integrated_; }

 private:
  struct PendingReading {
    int disc = 0;
    std::int64_t utime = 0;  // [us]
    double range = 0.0;      // [m]
    bool has_echo = false;
  };
  void on_pose(const pose_t& pose);
  void on_sonar(const sonar_t& sonar);
  void on_map_command(const map_command_t& command);
  void on_tile_request(const tile_request_t& request);

  [[nodiscard]] bool is_trusted(const pose_t& pose) const;
  void draw_pending();
  void send_tiles(std::int64_t utime);
  void start_map(const PriorMap& prior, std::int64_t session);
  std::string carry_out(const map_command_t& command);
  void keep_evidence(std::int64_t utime);

  lcm::LCM& lcm_;
  MapperConfig config_;
  std::unique_ptr<GridMapper> mapper_;
  std::optional<TileSender> sender_;
  PoseHistory poses_;
  StampGuard pose_stamps_;
  StampGuard sonar_stamps_;
  std::vector<std::int64_t> drawn_until_;  // [us] per disc: each reading once
  std::deque<PendingReading> pending_;
  std::int64_t pose_session_ = 0;
  std::int64_t kept_at_ = 0;  // [us]
  std::int64_t integrated_ = 0;
  std::int64_t kept_integrated_ = 0;
  std::string keep_error_;
  Subscriber subscriber_;  // last: no handler may run on a half-built node
};

}  // namespace luminav
