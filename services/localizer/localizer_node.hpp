#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/common/image/lamp_pictures.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/localizer/localizer_config.hpp"
#include "services/localizer/model/localizer.hpp"
#include "services/localizer/model/wheel_correction.hpp"
#include "services/localizer/pose_memory.hpp"

namespace luminav {

/// ODOMETRY, FIXTURE_DETECTIONS, SONAR, ROBOT_STATUS and INITIAL_POSE in; POSE with each ODOMETRY, and again of that
/// stamp when an image tells more, and HYPOTHESES at most five times a second out.
class LocalizerNode {
 public:
  /// With a key, commands without its seal are dropped.
  LocalizerNode(lcm::LCM& lcm, LocalizerConfig config, std::optional<CommandKey> key = {});

  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }
  [[nodiscard]] const Localizer& localizer() const { return *localizer_; }

 private:
  void on_odometry(const odometry_t& message);
  void on_fixture_detections(const fixture_detections_t& message);
  void on_sonar(const sonar_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_initial_pose(const initial_pose_t& message);
  void publish_pose(const LocalizerEstimate& estimate);
  void publish_hypotheses(std::int64_t utime);

  lcm::LCM& lcm_;
  LocalizerConfig config_;  // without the walls: the localizer has them in its own form
  std::unique_ptr<Localizer> localizer_;
  CorrectedOdometry wheels_;
  std::int64_t wheels_session_ = 0;
  PoseMemory memory_;
  StampGuard odometry_stamps_;
  StampGuard detection_stamps_;
  LampPictures lamp_pictures_;
  StampGuard sonar_stamps_;
  std::int64_t odometry_session_ = 0;
  pose_t pose_{};                      // the last POSE
  std::int64_t hypotheses_utime_ = 0;  // [us] of the last HYPOTHESES
  std::int64_t last_frame_ = 0;        // [us] of odometry when the newest image was heard of
  odometry_t odometry_{};              // the newest; stamp 0 = none yet
  std::int64_t guess_id_ = 0;          // of the last INITIAL_POSE taken up
  Subscriber subscriber_;              // last: handlers may run as soon as it exists
};

}  // namespace luminav
