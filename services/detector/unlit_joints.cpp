#include "services/detector/unlit_joints.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/joint_search.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kLargest = 0.018;      // [m] to move
constexpr double kCovered = 0.0025;     // [m] by which an edge lies beyond the joint's, where the fixture covers it ...
constexpr double kClearer = 0.0032;     // ... and more than on the opposite side
constexpr double kTrustedEnd = 0.0010;  // [m] error of a place given by ends without joints ...
constexpr double kTrustedSide = 0.0006;  // ... and by long sides
constexpr double kCovering = 0.0025;     // [m] by one that covers its joint
constexpr double kNoisy = 0.1;           // [px] error of a side whose step is as high as the noise of a pixel

/// How far an edge lies beyond the joint's.
double cover(const JointBeside& beside, double edge) {
  return beside.found ? edge - beside.end : 1.0;
}

/// What opposite sides say about the place between them.
class OppositeEdges {
 public:
  OppositeEdges(const JointBeside& positive, double positive_edge, const JointBeside& negative, double negative_edge)
      : positive_(positive), negative_(negative), positive_edge_(positive_edge), negative_edge_(negative_edge) {}

  /// Moves an outline's place along one axis of its frame; [m], and [m^2] of other errors.
  [[nodiscard]] double settle(int axis, double least_variance, OutlineFit& fit) const {
    if (!positive_.is_in_view || !negative_.is_in_view) {
      return 0.0;
    }
    const double by_positive = cover(positive_, positive_edge_);
    const double by_negative = cover(negative_, negative_edge_);
    double shift = 0.0;
    if (positive_.found || negative_.found) {
      if (by_negative > kCovered && by_negative - by_positive > kClearer) {
        shift = -negative_edge_;
      } else if (by_positive > kCovered && by_positive - by_negative > kClearer) {
        shift = positive_edge_;
      } else {
        return 0.0;
      }
    }
    if (std::abs(shift) > kLargest) {
      return 0.0;
    }
    const double sigma = positive_.found && negative_.found ? kCovering : axis == 0 ? kTrustedEnd : kTrustedSide;
    fit.covariance.row(axis).head<2>().setZero();
    fit.covariance.col(axis).head<2>().setZero();
    const double variance = sigma * sigma + least_variance;
    // The outline turns about the middle of what is seen of it.
    const double arm = axis == 1 ? -0.5 * (fit.visible_from + fit.visible_to) : 0.0;
    fit.covariance(axis, axis) = variance + arm * arm * fit.covariance(2, 2);
    fit.covariance(axis, 2) = fit.covariance(2, axis) = arm * fit.covariance(2, 2);
    return shift;
  }

 private:
  JointBeside positive_;
  JointBeside negative_;
  double positive_edge_;
  double negative_edge_;
};

}  // namespace

void take_off_joints(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                     const OutlineFitParams& params, OutlineFit& fit) {
  if (outline.shape == FixtureShape::kRound) {
    return;
  }
  const Pose2 pose = fit.robot_from_outline;
  const auto beside = [&](const Vector2d& along, const Vector2d& out, double length, double width) {
    return find_joint_beside(image, camera, {pose, outline.height, along, out, 0.5 * length, 0.5 * width},
                             {.noise = params.pixel_noise});
  };
  const Vector2d x = Vector2d::UnitX();
  const Vector2d y = Vector2d::UnitY();
  const double least_variance =
      (std::pow(params.outline_sigma_px, 2) + std::pow(kNoisy * params.pixel_noise / std::max(fit.step, 1.0), 2)) *
      fit.metres_per_px * fit.metres_per_px;
  Vector2d shift = Vector2d::Zero();
  if (fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd)) {
    const OppositeEdges ends(beside(y, x, outline.width, outline.length), fit.side_edge[kFarEnd],
                             beside(y, -x, outline.width, outline.length), fit.side_edge[kNearEnd]);
    shift.x() = ends.settle(0, least_variance, fit);
  }
  const OppositeEdges sides(beside(x, y, outline.length, outline.width), fit.side_edge[kLeftSide],
                            beside(x, -y, outline.length, outline.width), fit.side_edge[kRightSide]);
  shift.y() = sides.settle(1, least_variance, fit);
  fit.robot_from_outline = pose * Pose2{shift.x(), shift.y(), 0.0};
}

}  // namespace luminav
