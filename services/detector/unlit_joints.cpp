#include "services/detector/unlit_joints.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/detector/covered_joints.hpp"
#include "services/detector/joint_search.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kLargest = 0.018;      // [m] to move
constexpr double kCovered = 0.0025;     // [m] by which an edge lies beyond the joint's, where the fixture covers it ...
constexpr double kClearer = 0.0032;     // ... and more than on the opposite side
constexpr double kTrustedEnd = 0.0007;  // [m] error of a place given by ends without joints ...
constexpr double kLoneEnd = 0.0014;     // ... by one end without a joint, the other not being in view ...
constexpr double kTrustedSide = 0.0003;  // ... and by long sides
constexpr double kCovering = 0.0025;     // [m] by one that covers its joint
constexpr double kNoisy = 0.1;           // [px] error of a side whose step is as high as the noise of a pixel

/// How far an edge lies beyond the joint's.
double cover(const JointBeside& beside, double edge) {
  return beside.found ? edge - beside.end : 1.0;
}

/// Of the outline's place along one axis of its frame [m^2].
void set_variance(int axis, double variance, OutlineFit& fit) {
  fit.covariance.row(axis).head<2>().setZero();
  fit.covariance.col(axis).head<2>().setZero();
  // The outline turns about the middle of what is seen of it.
  const double arm = axis == 1 ? -0.5 * (fit.visible_from + fit.visible_to) : 0.0;
  fit.covariance(axis, axis) = variance + arm * arm * fit.covariance(2, 2);
  fit.covariance(axis, 2) = fit.covariance(2, axis) = arm * fit.covariance(2, 2);
}

/// What opposite sides say about the place between them.
class OppositeEdges {
 public:
  OppositeEdges(const JointBeside& positive, double positive_edge, const JointBeside& negative, double negative_edge)
      : positive_(positive), negative_(negative), positive_edge_(positive_edge), negative_edge_(negative_edge) {}

  /// Moves an outline's place along one axis of its frame; [m], and [m^2] of other errors.
  [[nodiscard]] std::optional<double> settle(int axis, double least_variance, OutlineFit& fit) const {
    if (!positive_.is_in_view || !negative_.is_in_view) {
      return std::nullopt;
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
        return std::nullopt;
      }
    }
    if (std::abs(shift) > kLargest) {
      return std::nullopt;
    }
    const double sigma = positive_.found && negative_.found ? kCovering : axis == 0 ? kTrustedEnd : kTrustedSide;
    set_variance(axis, sigma * sigma + least_variance, fit);
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
  const double least_variance =
      (std::pow(params.outline_sigma_px, 2) + std::pow(kNoisy * params.pixel_noise / std::max(fit.step, 1.0), 2)) *
      fit.metres_per_px * fit.metres_per_px;
  const auto joint_beside = [&](const SideLine& side) {
    return find_joint_beside(image, camera, side, {.noise = params.pixel_noise});
  };
  const auto costs_of = [&](const SideLine& side) {
    return end_costs(image, camera, side, fit.metres_per_px, params.pixel_noise);
  };
  bool is_joint_along = false;
  const auto settle_between = [&](int axis, const SideLine& positive, Side positive_side, const SideLine& negative,
                                  Side negative_side) {
    const JointBeside by_positive = joint_beside(positive);
    const JointBeside by_negative = joint_beside(negative);
    const OppositeEdges edges(by_positive, fit.side_edge[positive_side], by_negative, fit.side_edge[negative_side]);
    is_joint_along = is_joint_along || (axis == 1 && (by_positive.found || by_negative.found));
    if (axis == 1) {
      if (const auto shift = edges.settle(axis, least_variance, fit)) {
        return *shift;
      }
    }
    if (by_positive.found || by_negative.found) {
      const auto positive_costs = costs_of(positive);
      const auto negative_costs = costs_of(negative);
      if (positive_costs && negative_costs) {
        const PlaceBetween between = place_between(*positive_costs, *negative_costs, positive.distance);
        set_variance(axis, between.variance + least_variance, fit);
        return between.shift;
      }
    }
    return edges.settle(axis, least_variance, fit).value_or(0.0);
  };
  const auto settle_end = [&](const SideLine& end, Side side) {
    const JointBeside beside = joint_beside(end);
    if (beside.found) {
      if (const auto costs = costs_of(end)) {
        const PlaceBetween place = place_of(*costs);
        set_variance(0, place.variance + least_variance, fit);
        return place.shift;
      }
    } else if (beside.is_in_view) {
      set_variance(0, kLoneEnd * kLoneEnd + least_variance, fit);
    }
    // What looked like swelling was the joint.
    return is_joint_along && !beside.found ? fit.side_edge[side] : 0.0;
  };
  const auto line = [&](const Vector2d& along, const Vector2d& out, double length, double width) {
    return SideLine{pose, outline.height, along, out, 0.5 * length, 0.5 * width};
  };
  const Vector2d x = Vector2d::UnitX();
  const Vector2d y = Vector2d::UnitY();
  Vector2d shift = Vector2d::Zero();
  shift.y() = settle_between(1, line(x, y, outline.length, outline.width), kLeftSide,
                             line(x, -y, outline.length, outline.width), kRightSide);
  const SideLine far_end = line(y, x, outline.width, outline.length);
  const SideLine near_end = line(y, -x, outline.width, outline.length);
  if (fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd)) {
    shift.x() = settle_between(0, far_end, kFarEnd, near_end, kNearEnd);
  } else if (fit.end_visible(kFarEnd)) {
    shift.x() = settle_end(far_end, kFarEnd);
  } else if (fit.end_visible(kNearEnd)) {
    shift.x() = -settle_end(near_end, kNearEnd);
  }
  fit.robot_from_outline = pose * Pose2{shift.x(), shift.y(), 0.0};
}

}  // namespace luminav
