#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "drivers/camera/simulated/truth.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/camera_model.hpp"

namespace luminav {

/// Where the robot is and how it moves when the middle row of a frame is exposed.
struct FrameMoment {
  simulated::TruePose pose;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // [m/s] world
  double angular = 0.0;                                // [rad/s]
};

/// From the truth around a frame's middle [us]; nothing when it is not known. `frame_time` [us] from the first row to
/// the last.
std::optional<FrameMoment> moment_at(const simulated::TruthBuffer& truth, double middle, double frame_time);

/// What an image says of one fixture to somebody who knows the camera only as the robot's file has it.
struct FixtureView {
  std::size_t index = 0;   // in the building's file
  double share = 0.0;      // 0..1 of the area that is in the image
  bool near_end = false;   // the end towards -x of the fixture is in the image
  bool far_end = false;    // the end towards +x
  double seen_from = 0.0;  // [m] stretch of the long sides in the image, from the fixture's centre
  double seen_to = 0.0;    // [m]
  double length = 0.0;     // [m] as believed
  Pose2 robot_from_line;   // on the axis as imaged: origin in the middle of the stretch, x along the fixture
  double near_at = 0.0;    // [m] where the ends appear on that line
  double far_at = 0.0;     // [m]

  /// Centre and direction as the image says them when these ends are taken for visible: between both ends, half a
  /// length from the only one, or the middle of the stretch that is seen.
  [[nodiscard]] Pose2 robot_from_fixture(bool near_end_visible, bool far_end_visible) const;
};

/// Projects the true ceiling through the true camera (tilt, lens, rolling shutter, tilt of the floor) and back through
/// the believed one: what a detector without any error of its own would report.
class CeilingViewer {
 public:
  CeilingViewer(const WorldTruth& world, const Building& believed, const CameraDescription& believed_camera);

  /// All fixtures of which at least `min_share` is in the image, in the building's order.
  void look(const FrameMoment& moment, const std::vector<simulated::MovedLamp>& moved, double min_share,
            std::vector<FixtureView>& views);

 private:
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector2d& in_world, double height) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> as_believed(const Pose2& world_from_fixture, double along,
                                                           std::size_t index) const;
  [[nodiscard]] bool view(std::size_t index, const Pose2& world_from_fixture, double min_share,
                          FixtureView& result) const;
  void measure_share(const Fixture& fixture, const Pose2& world_from_fixture, FixtureView& result) const;
  void near(const Eigen::Vector2d& centre, std::vector<std::size_t>& indices) const;

  std::vector<Fixture> fixtures_;  // true
  std::vector<Fixture> believed_;
  CeilingCamera true_camera_;
  CeilingCamera believed_camera_;
  double row_time_;    // [s] true
  double reach_;       // [m] beyond which no fixture is in the image
  double cell_ = 4.0;  // [m] of the index of fixtures by place
  int columns_ = 0;
  int rows_ = 0;
  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();
  std::vector<std::vector<std::size_t>> cells_;
  std::vector<std::size_t> found_;

  // of the moment looked at
  FrameMoment moment_;
  Eigen::Vector3d lens_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d camera_from_world_ = Eigen::Matrix3d::Identity();
};

}  // namespace luminav
