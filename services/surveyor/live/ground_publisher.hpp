#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/tile_request_t.hpp>
#include <optional>

#include "services/mapper/tile_sender.hpp"
#include "services/surveyor/live/live_ground.hpp"

namespace luminav {

/// Publishes what localizer and mapper publish where a building is known: POSE and GRID_TILE of a survey.
class GroundPublisher {
 public:
  explicit GroundPublisher(lcm::LCM& lcm) : lcm_(lcm) {}

  /// POSE at a reading and the tiles that are due. Nobody needs a POSE while a person drives: the controller would keep
  /// the robot from what is only half drawn.
  void publish(const OdometryReading& reading, LiveGround& ground, bool is_exploring);
  /// False for a request of an impossible size.
  [[nodiscard]] bool take(const tile_request_t& request) { return !tiles_ || tiles_->take(request); }

 private:
  void publish_pose(const OdometryReading& reading, const LiveGround& ground);

  lcm::LCM& lcm_;
  std::optional<TileSender> tiles_;
  int drawing_ = 0;  // that the tiles show
  std::int32_t sequence_ = 0;
};

}  // namespace luminav
