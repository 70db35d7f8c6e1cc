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

  /// How far the outline is to be moved along one axis of its frame [m]; that axis of the fit's covariance becomes what
  /// this leaves open and `least_variance` [m^2] of other errors. Nothing, and no change, when joints leave no side to
  /// go by.
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

/// Settles one axis of an unlit outline after the other.
class JointRemoval {
 public:
  JointRemoval(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
               const OutlineFitParams& params, OutlineFit& fit)
      : image_(image), camera_(camera), outline_(outline), noise_(params.pixel_noise), fit_(fit) {
    const double error_px = std::hypot(params.outline_sigma_px, kNoisy * noise_ / std::max(fit.step, 1.0));
    least_variance_ = std::pow(error_px * fit.metres_per_px, 2);
  }

  /// [m] to move it towards its left side.
  [[nodiscard]] double settle_across() {
    const SideLine left = side_line(kLeftSide);
    const SideLine right = side_line(kRightSide);
    const JointBeside by_left = joint_beside(left);
    const JointBeside by_right = joint_beside(right);
    is_joint_along_ = by_left.found || by_right.found;
    if (const auto shift = edges(by_left, kLeftSide, by_right, kRightSide).settle(1, least_variance_, fit_)) {
      return *shift;
    }
    return is_joint_along_ ? settle_by_profiles(1, &left, &right, CeilingOutside::kAsBeyondCorners).value_or(0.0) : 0.0;
  }

  /// [m] to move it towards its far end.
  [[nodiscard]] double settle_along() {
    const bool far = fit_.end_visible(kFarEnd);
    const bool near = fit_.end_visible(kNearEnd);
    return far && near ? settle_between_ends() : far ? settle_end(kFarEnd) : near ? -settle_end(kNearEnd) : 0.0;
  }

 private:
  [[nodiscard]] SideLine side_line(Side side) const {
    const bool end = side == kFarEnd || side == kNearEnd;
    const double sign = side == kLeftSide || side == kFarEnd ? 1.0 : -1.0;
    const Vector2d x = Vector2d::UnitX();
    const Vector2d y = Vector2d::UnitY();
    return {fit_.robot_from_outline,
            outline_.height,
            end ? y : x,
            sign * (end ? x : y),
            0.5 * (end ? outline_.width : outline_.length),
            0.5 * (end ? outline_.length : outline_.width)};
  }
  static CeilingOutside outside_of(bool is_joint) {
    return is_joint ? CeilingOutside::kAsBeyondCorners : CeilingOutside::kEven;
  }
  [[nodiscard]] JointBeside joint_beside(const SideLine& side) const {
    return find_joint_beside(image_, camera_, side, {.noise = noise_});
  }
  [[nodiscard]] std::optional<EndCosts> costs_of(const SideLine& side, CeilingOutside outside) const {
    return end_costs(image_, camera_, side, fit_.metres_per_px, noise_, outside);
  }
  [[nodiscard]] OppositeEdges edges(const JointBeside& by_positive, Side positive, const JointBeside& by_negative,
                                    Side negative) const {
    return {by_positive, fit_.side_edge[positive], by_negative, fit_.side_edge[negative]};
  }

  /// By all grey levels across both sides, or across one where the other is not in view; [m] towards the positive one.
  [[nodiscard]] std::optional<double> settle_by_profiles(int axis, const SideLine* positive, const SideLine* negative,
                                                         CeilingOutside outside) {
    const auto positive_costs = positive != nullptr ? costs_of(*positive, outside) : std::nullopt;
    const auto negative_costs = negative != nullptr ? costs_of(*negative, outside) : std::nullopt;
    const double half_size = 0.5 * (axis == 0 ? outline_.length : outline_.width);
    const auto place = positive_costs && negative_costs ? place_between(*positive_costs, *negative_costs, half_size)
                       : positive_costs                 ? place_of(*positive_costs, half_size)
                       : negative_costs                 ? place_of(*negative_costs, half_size)
                                                        : std::nullopt;
    if (!place) {
      return std::nullopt;
    }
    set_variance(axis, place->variance + least_variance_, fit_);
    return positive_costs ? place->shift : -place->shift;
  }

  [[nodiscard]] double settle_between_ends() {
    const SideLine far = side_line(kFarEnd);
    const SideLine near = side_line(kNearEnd);
    const JointBeside by_far = joint_beside(far);
    const JointBeside by_near = joint_beside(near);
    // A short side's edge points are few, each found in noise for itself: the profile of the whole side says more. An
    // end so close to the image's border that no joint would show beside it may be one.
    const auto shift = settle_by_profiles(0, by_far.is_in_view ? &far : nullptr, by_near.is_in_view ? &near : nullptr,
                                          outside_of(by_far.found || by_near.found));
    return shift ? *shift : edges(by_far, kFarEnd, by_near, kNearEnd).settle(0, least_variance_, fit_).value_or(0.0);
  }

  /// [m] to move the only end in view outwards.
  [[nodiscard]] double settle_end(Side side) {
    const SideLine end = side_line(side);
    const JointBeside beside = joint_beside(end);
    if (!beside.is_in_view) {
      return 0.0;
    }
    if (const auto shift = settle_by_profiles(0, &end, nullptr, outside_of(beside.found))) {
      return *shift;
    }
    if (beside.found) {
      return 0.0;
    }
    set_variance(0, kLoneEnd * kLoneEnd + least_variance_, fit_);
    // What looked like swelling was the joint.
    const double edge = fit_.side_edge[side];
    return is_joint_along_ && std::abs(edge) <= kLargest ? edge : 0.0;
  }

  const GreyView& image_;
  const CeilingCamera& camera_;
  const Outline& outline_;
  double noise_;  // [grey]
  OutlineFit& fit_;
  double least_variance_ = 0.0;  // [m^2] of other errors
  bool is_joint_along_ = false;  // beside a long side
};

}  // namespace

void take_off_joints(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                     const OutlineFitParams& params, OutlineFit& fit) {
  if (outline.shape == FixtureShape::kRound) {
    return;
  }
  JointRemoval removal(image, camera, outline, params, fit);
  const double across = removal.settle_across();
  const double along = removal.settle_along();
  fit.robot_from_outline = fit.robot_from_outline * Pose2{along, across, 0.0};
}

}  // namespace luminav
