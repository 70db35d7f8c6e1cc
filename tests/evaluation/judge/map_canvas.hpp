#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// A map as a picture to draw on, in metres of the world; free white, occupied dark, unknown grey. 40 px per metre, of
/// large buildings 20.
class MapCanvas {
 public:
  explicit MapCanvas(const PriorMap& map);

  void rectangle(const Pose2& world_from_box, double length, double width, const cv::Scalar& colour);
  void line(const Pose2& from, const Pose2& to, const cv::Scalar& colour, int thickness_px);
  void dot(const Eigen::Vector2d& p, int radius_px, const cv::Scalar& colour, bool filled = true);
  /// A dot with a stroke along theta.
  void arrow(const Pose2& pose, double length, const cv::Scalar& colour);
  void text(const Eigen::Vector2d& p, const std::string& words, const cv::Scalar& colour);
  [[nodiscard]] cv::Mat& image() { return image_; }
  /// Throws std::runtime_error when it cannot be written.
  void write(const std::string& png_file) const;

 private:
  [[nodiscard]] cv::Point at(const Eigen::Vector2d& p) const;

  GridGeometry geometry_;
  int scale_;  // [px per m]
  cv::Mat image_;
};

}  // namespace luminav
