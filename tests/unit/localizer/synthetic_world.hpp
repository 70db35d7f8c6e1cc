#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/model/wall_field.hpp"
#include "tests/support/fixture_visibility.hpp"

namespace luminav::testing {

/// What the synthetic world does to its robot. 1-sigma values are those of the project's truth around belief.
struct SyntheticOptions {
  std::uint64_t seed = 1;
  bool calibrated = false;  // constant errors a tenth
  bool perfect = false;     // no errors at all
  // which errors there are: each can be switched off to find out what it costs
  bool wheel_errors = true;
  bool camera_errors = true;
  bool time_errors = true;
  bool fixture_errors = true;
  bool floor_errors = true;
  bool odometry_noise = true;
  double off_ratio = 0.0;       // of the fixtures
  double overlooked = 0.15;     // share of the unlit fixtures that are never detected
  double miss_lit = 0.02;       // per image
  double miss_unlit = 0.20;     // per image
  double false_alarm = 0.002;   // per image, anywhere
  int clutter = 1;              // things on the ceiling that pass for fixtures in every other image
  int unknown_boxes = 4;        // in the way of sonar and robot, not in the map
  double sonar_dropout = 0.4;   // of beams that meet a wall at a slant
  double speed = 0.4;           // [m/s]
  double spin_distance = 0.0;   // [m] after which it turns once on the spot, as one drives to calibrate; 0 = never
  double image_latency = 0.06;  // [s]
  std::optional<Pose2> start{};
};

/// A robot wandering about in a building, with sightings made from geometry instead of pictures: quick enough for
/// thousands of drives. True camera, lens, fixtures, wheels and floor differ from what is believed.
class SyntheticWorld {
 public:
  SyntheticWorld(const Building& believed, const PriorMap& walls, const RobotDescription& robot,
                 const SyntheticOptions& options);

  /// Messages that became known in the last step.
  struct Output {
    std::optional<OdometryReading> odometry;
    std::optional<SightingFrame> frame;
    std::optional<SonarScan> sonar;
  };
  /// 1/30 s onward.
  Output step();
  /// Puts the robot elsewhere and holds it there for two seconds; its wheels stand still meanwhile.
  void kidnap(const Pose2& pose);
  /// From now on sightings are placed as a robot does whose file says this; what is true stays.
  void believe(const RobotDescription& robot) { robot_ = robot; }
  /// A random free pose.
  Pose2 draw_free_pose();

  [[nodiscard]] const Pose2& truth() const { return truth_; }
  [[nodiscard]] const Building& believed() const { return believed_; }
  [[nodiscard]] const RobotDescription& believed_robot() const { return robot_; }
  [[nodiscard]] const PriorMap& map_walls() const { return map_walls_.map(); }
  /// What the robot, its wheels and the ceiling are really like.
  [[nodiscard]] const RobotDescription& true_robot() const { return true_robot_; }
  [[nodiscard]] double true_ceiling_height() const { return true_building_.ceiling_height; }
  [[nodiscard]] double true_wheel_scale() const { return 0.5 * (scale_left_ + scale_right_) - 1.0; }
  [[nodiscard]] double true_wheel_ratio() const {
    return 2.0 * (scale_right_ - scale_left_) / (scale_right_ + scale_left_);
  }
  [[nodiscard]] double true_wheel_base() const { return true_base_; }
  [[nodiscard]] double driven() const { return driven_; }
  [[nodiscard]] std::int64_t utime() const { return utime_; }
  /// What the true camera ought to see of the true fixtures that its detector can find at all.
  [[nodiscard]] FixtureVisibility visibility() const;

 private:
  [[nodiscard]] double uniform(double min, double max);
  [[nodiscard]] double gauss(double sigma);
  void steer();
  [[nodiscard]] std::optional<FixtureSighting> see(const Fixture& true_fixture, const Pose2& pose, bool exact);
  [[nodiscard]] SightingFrame look(const Pose2& pose, double linear, double angular);
  [[nodiscard]] SonarScan hear();
  [[nodiscard]] Pose2 truth_later(double seconds) const;

  Building believed_;
  RobotDescription robot_;
  SyntheticOptions options_;
  std::mt19937_64 generator_;
  Building true_building_;
  WallField walls_;  // with the unknown boxes
  WallField map_walls_;
  RobotDescription true_robot_;
  std::vector<bool> lit_;
  std::vector<bool> never_seen_;
  std::vector<Fixture> clutter_;
  double scale_left_ = 1.0;
  double scale_right_ = 1.0;
  double true_base_ = 0.33;
  double floor_roll_ = 0.0;
  double floor_pitch_ = 0.0;
  double since_floor_ = 1e9;

  Pose2 truth_;
  Pose2 odom_;
  double linear_ = 0.0;
  double angular_ = 0.0;
  double wanted_turn_ = 0.0;
  double spun_at_ = 0.0;     // [m]
  double spin_ = 2.0 * kPi;  // [rad] the next turn on the spot, left and right in turns
  double driven_ = 0.0;
  std::int64_t utime_ = 1'000'000'000;
  std::int64_t held_until_ = 0;  // [us]
  int tick_ = 0;
  std::deque<std::pair<std::int64_t, SightingFrame>> pending_;  // due time, frame
  int next_disc_ = 0;
};

/// A corridor that looks the same from both ends: one row of fixtures at a regular pitch, walls all round.
struct TestBuilding {
  Building building;
  PriorMap walls;
};
TestBuilding symmetric_corridor(int fixtures, double pitch);
/// Two rooms of different size with fixtures of two kinds, joined by a door.
TestBuilding two_rooms();

}  // namespace luminav::testing
