#include "services/detector/unlit_joints.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/detector/covered_joints.hpp"
#include "services/detector/joint_search.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kFarthest = 0.062;  // [m] outwards of a side, of a joint that its profile would cross
constexpr double kBeside = 0.030;    // [m] the same of one that may reach under the side where a fixture hangs askew
// Lines in which a joint is looked for beyond each corner, about as far apart as pixels are: in dim light it is hardly
// deeper than their noise, and beside one that is missed the end lies elsewhere.
constexpr double kApart = 0.006;  // [m]
constexpr int kLines = 32;
constexpr double kLargest = 0.018;        // [m] to move
constexpr double kLoneEnd = 0.0014;       // [m] error of a place given by the edge points of the only end in view
constexpr double kOneSidedBloom = 0.005;  // [m] by which bloom on one side may move an outline, at least

/// Of the outline's place along one axis of its frame [m^2].
void set_variance(int axis, double variance, OutlineFit& fit) {
  fit.covariance.row(axis).head<2>().setZero();
  fit.covariance.col(axis).head<2>().setZero();
  // The outline turns about the middle of what is seen of it.
  const double arm = axis == 1 ? -0.5 * (fit.visible_from + fit.visible_to) : 0.0;
  fit.covariance(axis, axis) = variance + arm * arm * fit.covariance(2, 2);
  fit.covariance(axis, 2) = fit.covariance(2, axis) = arm * fit.covariance(2, 2);
}

/// Settles one axis of an unlit outline after the other.
class JointRemoval {
 public:
  JointRemoval(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
               const OutlineFitParams& params, OutlineFit& fit)
      : image_(image), camera_(camera), outline_(outline), noise_(params.pixel_noise), fit_(fit) {
    least_variance_ = std::pow(params.outline_sigma_px * fit.metres_per_px, 2);
  }

  /// [m] to move it towards its left side.
  [[nodiscard]] double settle_across() {
    const Beside left = look_beside(kLeftSide);
    const Beside right = look_beside(kRightSide);
    const bool is_left_free = !left.joint.found || left.joint.middle > kBeside;
    const bool is_right_free = !right.joint.found || right.joint.middle > kBeside;
    is_joint_along_ = !is_left_free || !is_right_free;
    // Where it is not seen whether a joint runs along, edge points decide: of both sides they tell it by its step down.
    const bool is_clear = left.joint.is_in_view && right.joint.is_in_view;
    if (!is_clear && !is_joint_along_) {
      return 0.0;
    }
    // A fixture hangs askew between the joints: over a long side that is as much as the joint is wide. The side without
    // one says enough.
    if (is_clear && is_left_free != is_right_free) {
      if (const auto shift = settle_by(1, is_left_free ? left : right)) {
        return is_left_free ? *shift : -*shift;
      }
    }
    return settle_between(1, left, right).value_or(0.0);
  }

  /// The same by one side, whose edge lies `beyond` [m] outwards of the outline; nothing when it is not in view.
  [[nodiscard]] std::optional<double> settle_across_by(Side side, double beyond) {
    Beside beside{side_line(side), {}};
    beside.line.distance += beyond;
    beside.joint = joint_beside(beside.line);
    const auto outwards = settle_by(1, beside);
    return outwards ? std::optional((side == kLeftSide ? 1.0 : -1.0) * (beyond + *outwards)) : std::nullopt;
  }

  /// [m] to move it towards its far end.
  [[nodiscard]] double settle_along() {
    const bool far = fit_.end_visible(kFarEnd);
    const bool near = fit_.end_visible(kNearEnd);
    return far && near ? settle_between(0, look_beside(kFarEnd), look_beside(kNearEnd)).value_or(0.0)
           : far       ? settle_end(kFarEnd)
           : near      ? -settle_end(kNearEnd)
                       : 0.0;
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
  /// A side, and what runs along it.
  struct Beside {
    SideLine line;
    JointBeside joint;
  };
  [[nodiscard]] Beside look_beside(Side side) const {
    const SideLine line = side_line(side);
    return {line, joint_beside(line)};
  }
  [[nodiscard]] JointBeside joint_beside(const SideLine& line) const {
    return find_joint_beside(image_, camera_, line,
                             {.farthest = kFarthest, .apart = kApart, .lines = kLines, .noise = noise_});
  }
  /// Nothing for a side so close to the image's border that no joint would show beside it: there may be one.
  [[nodiscard]] std::optional<EndCosts> costs_of(const Beside& side) const {
    if (!side.joint.is_in_view) {
      return std::nullopt;
    }
    std::optional<CeilingJoint> joint;
    if (side.joint.found) {
      joint = fit_ceiling_joint(image_, camera_, side.line, side.joint.middle, fit_.metres_per_px);
      if (!joint) {
        return std::nullopt;
      }
    }
    return end_costs(image_, camera_, side.line, fit_.metres_per_px, noise_, joint);
  }

  /// By all grey levels across opposite sides, or across one where the other says nothing: edge points are each found
  /// in noise for itself, the profile of a whole side says more. [m] towards the positive one.
  [[nodiscard]] std::optional<double> settle_between(int axis, const Beside& positive, const Beside& negative) {
    const double half_size = 0.5 * (axis == 0 ? outline_.length : outline_.width);
    const auto positive_costs = costs_of(positive);
    const auto negative_costs = costs_of(negative);
    if (positive_costs && negative_costs) {
      const auto place = place_between(*positive_costs, *negative_costs, half_size, blurs_);
      learn_blur(*positive_costs, blurs_);
      learn_blur(*negative_costs, blurs_);
      return settle(axis, place);
    }
    if (positive_costs) {
      return settle(axis, *positive_costs);
    }
    const auto inwards = negative_costs ? settle(axis, *negative_costs) : std::nullopt;
    return inwards ? std::optional(-*inwards) : std::nullopt;
  }
  /// By one side alone; [m] outwards of it.
  [[nodiscard]] std::optional<double> settle_by(int axis, const Beside& side) {
    const auto costs = costs_of(side);
    return costs ? settle(axis, *costs) : std::nullopt;
  }
  [[nodiscard]] std::optional<double> settle(int axis, const EndCosts& costs) {
    const auto place = place_of(costs, 0.5 * (axis == 0 ? outline_.length : outline_.width), blurs_);
    learn_blur(costs, blurs_);
    return settle(axis, place);
  }

  /// [m] to move it.
  [[nodiscard]] std::optional<double> settle(int axis, const std::optional<PlaceBetween>& place) {
    if (!place) {
      return std::nullopt;
    }
    set_variance(axis, place->variance + least_variance_, fit_);
    return place->shift;
  }

  /// [m] to move the only end in view outwards.
  [[nodiscard]] double settle_end(Side side) {
    const Beside end = look_beside(side);
    if (!end.joint.is_in_view) {
      return 0.0;
    }
    if (const auto shift = settle_by(0, end)) {
      return *shift;
    }
    if (end.joint.found) {
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
  BlurCosts blurs_{};            // as the sides looked at so far show it
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

void place_by_dark_half(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                        const OutlineFitParams& params, const OutlineFit& seen, Side dark_side, OutlineFit& fit) {
  const double outwards = dark_side == kLeftSide ? 1.0 : -1.0;
  const double moved = (seen.robot_from_outline.inverse() * fit.robot_from_outline).y;
  JointRemoval removal(image, camera, outline, params, fit);
  const auto across = removal.settle_across_by(dark_side, seen.side_edge[dark_side] - outwards * moved);
  if (across) {
    fit.robot_from_outline = fit.robot_from_outline * Pose2{0.0, *across, 0.0};
  } else {
    fit.covariance(1, 1) += std::pow(std::max(fit.swelling, kOneSidedBloom), 2);
  }
}

}  // namespace luminav
