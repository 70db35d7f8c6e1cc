#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// What of the ceiling the camera sees, in the robot frame.
class CeilingView {
 public:
  explicit CeilingView(const CameraDescription& camera);

  /// Share 0..1 of a fixture's area that lies in the image with at least `margin` [m] on the ceiling to its border.
  [[nodiscard]] double visible_share(const Pose2& robot_from_fixture, const Fixture& fixture, double margin) const;

  /// Whether that share is 1, in less time.
  [[nodiscard]] bool is_wholly_visible(const Pose2& robot_from_fixture, const Fixture& fixture, double margin) const;

  /// Radius [m] round the robot beyond which nothing of a ceiling at this height is seen.
  [[nodiscard]] double radius(double height) const;
  /// Radius [m] of a disc as large as the image on a ceiling at this height.
  [[nodiscard]] double mean_radius(double height) const;
  /// [m] from the camera up to a ceiling at this height.
  [[nodiscard]] double height_above_camera(double height) const { return height - camera_.mounting.z; }

  /// The sighting as a camera that reads all rows at once would have had it: each point of the ceiling was seen when
  /// its row was read, while the robot moved on. `height` [m] of the ceiling; twist in the robot frame.
  [[nodiscard]] FixtureSighting without_rolling_shutter(const FixtureSighting& sighting, double height, double linear,
                                                        double angular) const;

 private:
  struct Side {
    Eigen::Vector2d start;
    Eigen::Vector2d along;  // unit
  };

  /// Whether a point of a ceiling `height` [m] above the camera lies in the image, `margin` [m] from its border.
  [[nodiscard]] bool is_inside(const Eigen::Vector2d& point, double height, double margin) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> wide_border() const;
  [[nodiscard]] Eigen::Vector2d at_middle_row(const Eigen::Vector2d& point, double height, double linear,
                                              double angular) const;

  CameraDescription camera_;
  CeilingCamera model_;
  std::vector<Eigen::Vector2d> border_;  // image border on a plane 1 m above the camera, robot axes, counter-clockwise
  std::vector<Side> sides_;              // of the border
};

}  // namespace luminav
