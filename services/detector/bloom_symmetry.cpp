#include "services/detector/bloom_symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/detector/bloom_edges.hpp"
#include "services/detector/bloom_regression.hpp"
#include "services/detector/joint_search.hpp"
#include "services/detector/opposite_sides.hpp"
#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kInside = Differences::kInside;
constexpr int kDistances = Differences::kDistances;
constexpr double kBloomReach = 0.05;     // [m] from a corner, beyond which a joint shows
constexpr double kNarrowBloom = 0.008;   // [m] of swelling; in broader bloom a joint shows less than on the ceiling
constexpr double kUnevenBloom = 0.01;    // of the swelling, 1 sigma
constexpr double kLargestShift = 0.008;  // [m] ...
constexpr double kLargestShare = 0.5;    // ... or this share of the swelling: of a joint in broad bloom
constexpr double kSettled = 0.15;        // [px] of a shift: the next is mostly a tenth of it, less than its error
// How far off level bloom may put an outline, 1 sigma (rendered frames):
constexpr double kLevelSigmaPx = 0.7;
constexpr double kUnevenLevel = 0.2;  // of the swelling

/// [m] by which to go back of what an outline was `moved` along it from where its bloom is level. Where the ceilings
/// beyond its ends are far from equally bright the balance is less sure than the level.
double go_back(double moved, double level_variance, Balance& balance) {
  const double share = balance.uneven_variance / (balance.uneven_variance + level_variance);
  balance.covariance(0, 0) -= share * balance.uneven_variance;
  return -share * moved;
}

/// The only end whose bloom could be levelled, the border being too close to the other: 1 the far one, -1 the near one;
/// 0 if that is true of both or none.
int only_level_end(const GreyView& image, const CeilingCamera& camera, const Outline& outline, const OutlineFit& fit) {
  const auto is_in_view = [&](double end) {
    const double edge = 0.5 * outline.length + fit.swelling;
    for (const double place : {edge, edge + kBloomSearch * fit.metres_per_px}) {
      const auto pixel =
          camera.pixel_of_ceiling_point(fit.robot_from_outline * Vector2d(end * place, 0.0), outline.height);
      if (!pixel || !is_sampled(image, *pixel)) {
        return false;
      }
    }
    return true;
  };
  return (is_in_view(1.0) ? 1 : 0) - (is_in_view(-1.0) ? 1 : 0);
}

/// Opposite sides with the joints beside them. Those are looked for only when the differences are not explained
/// without: most lamps have none, and the look costs as much as all else.
class SidePair {
 public:
  SidePair(const GreyView& image, const CeilingCamera& camera, const Outline& outline, const OutlineFitParams& params,
           const OutlineFit& fit, bool across)
      : image_(image),
        camera_(camera),
        height_(outline.height),
        noise_(params.pixel_noise),
        swelling_(fit.swelling),
        step_(fit.metres_per_px),
        along_(across ? Vector2d::UnitX() : Vector2d::UnitY()),
        out_(across ? Vector2d::UnitY() : Vector2d::UnitX()),
        length_(across ? outline.length : outline.width),
        half_width_(0.5 * (across ? outline.width : outline.length)),
        // The burning half of a fixture fades into the dark one more slowly than into the ceiling.
        saturated_(across ? Saturated::kLeftOut : Saturated::kCutOff),
        sides_(image, camera, outline, params.vignetting, along_, out_, length_, half_width_ + swelling_) {}

  /// By how much an outline at `pose` is off balance.
  [[nodiscard]] std::optional<Balance> measure(const Pose2& pose) {
    constexpr KnownJoint kNone{.is_known = true};
    Differences differences = sides_.measure(pose, step_, saturated_);
    can_be_compared_ = differences.count >= Differences::kLeast;
    if (!can_be_compared_) {
      return std::nullopt;
    }
    if (!joints_) {
      const std::optional<Balance> balance = balance_sides(differences, length_, step_, {kNone, kNone});
      if (balance && !balance->needs_joint) {
        return balance;
      }
      joints_ = {look_beside(pose, 1.0), look_beside(pose, -1.0)};
      if ((*joints_)[0].is_ruled_out() && (*joints_)[1].is_ruled_out()) {
        return balance;
      }
    }
    if ((*joints_)[0].is_seen() || (*joints_)[1].is_seen()) {
      if (swelling_ >= kNarrowBloom) {
        // Saturation cuts off a part of a joint that lies in broad bloom.
        differences = sides_.measure(pose, step_, Saturated::kLeftOut);
      } else if (sides_.take_ceiling_off(pose, step_, kBloomReach + swelling_, differences)) {
        return balance_sides(differences, length_, step_, {kNone, kNone});
      }
    }
    return balance_sides(differences, length_, step_, *joints_);
  }

  /// Whether there was enough to compare at the last measurement.
  [[nodiscard]] bool can_be_compared() const { return can_be_compared_; }

  /// The outline was moved towards the positive side.
  void move(double shift) {
    if (joints_) {
      (*joints_)[0].place -= shift / step_;
      (*joints_)[1].place += shift / step_;
    }
  }

 private:
  [[nodiscard]] KnownJoint look_beside(const Pose2& pose, double side) const {
    const JointSearch search{.nearest = swelling_ - kInside * step_,
                             .farthest = swelling_ + (kDistances - kInside) * step_,
                             .from_corner = kBloomReach + swelling_,
                             .noise = noise_};
    const JointBeside beside =
        find_joint_beside(image_, camera_, {pose, height_, along_, side * out_, 0.5 * length_, half_width_}, search);
    return {beside.is_in_view, beside.found, (beside.middle - swelling_) / step_ + kInside, beside.depth};
  }

  const GreyView& image_;
  const CeilingCamera& camera_;
  double height_;
  double noise_;  // [grey]
  double swelling_;
  double step_;
  Vector2d along_;
  Vector2d out_;
  double length_;
  double half_width_;
  Saturated saturated_;
  OppositeSides sides_;
  std::optional<KnownJoints> joints_;
  bool can_be_compared_ = false;
};

}  // namespace

void balance_bloom(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                   const OutlineFitParams& params, OutlineFit& fit) {
  if (outline.shape == FixtureShape::kRound) {
    return;
  }
  const double step = fit.metres_per_px;
  SidePair sides(image, camera, outline, params, fit, true);
  SidePair ends(image, camera, outline, params, fit, false);
  Pose2 pose = fit.robot_from_outline;
  const double largest_shift = std::max(kLargestShift, kLargestShare * fit.swelling);
  const double middle = 0.5 * (fit.visible_from + fit.visible_to);
  std::optional<Balance> across;
  std::optional<Balance> along;
  bool across_settled = false;
  bool along_settled = false;
  for (int pass = 0; pass < 3 && !(across_settled && along_settled); ++pass) {
    Pose2 change;
    if (!along_settled) {
      along = ends.measure(pose);
      if (along && std::abs(along->shift) > largest_shift) {
        along.reset();
      }
      // What does not come to rest is no balance: the level is kept then.
      change.x = along ? along->shift : (pose.inverse() * fit.robot_from_outline).x;
    }
    if (!across_settled) {
      across = sides.measure(pose);
      // The edges know the direction as well: the mean of both is better than either.
      change.theta = across && pass == 0 ? 0.5 * across->turn : 0.0;
      // What is left of the turn must not move what is seen of the sides.
      change.y = across ? across->shift + (across->turn - change.theta) * middle : 0.0;
    }
    if (std::abs(change.y) > largest_shift || std::abs(change.theta) > 0.02) {
      return;
    }
    pose = pose * change;
    sides.move(change.y);
    ends.move(change.x);
    along_settled = !along || std::abs(change.x) < kSettled * step;
    across_settled = std::abs(change.y) < kSettled * step;
  }
  const Pose2 moved = fit.robot_from_outline.inverse() * pose;
  const auto set_along = [&](double variance_along) {
    fit.covariance.row(0).setZero();
    fit.covariance.col(0).setZero();
    fit.covariance(0, 0) = variance_along;
  };
  Pose2 back;
  const double level_variance = std::pow(kLevelSigmaPx * step, 2) + std::pow(kUnevenLevel * fit.swelling, 2);
  if (along) {
    back.x = go_back(moved.x, level_variance, *along);
  } else {
    // What was off the level beside a long side went by halves into place and swelling, by which the end was placed.
    back.x = -only_level_end(image, camera, outline, fit) * std::abs(moved.y + moved.theta * middle);
    if (ends.can_be_compared()) {  // both are in view, and nothing says how far off the level is there
      set_along(level_variance);
    }
  }
  fit.robot_from_outline = pose * back;
  // Of the place `at` [m] along the sides.
  const auto variance = [&](const Balance& balance, double at) {
    return balance.covariance(0, 0) + 2.0 * at * balance.covariance(0, 1) + at * at * balance.covariance(1, 1) +
           std::pow(params.outline_sigma_px * step, 2) + std::pow(kUnevenBloom * fit.swelling, 2);
  };
  if (across) {
    const double lever = 0.3 * std::max(fit.visible_to - fit.visible_from, 0.5 * outline.width);
    fit.covariance.row(1).setZero();
    fit.covariance.col(1).setZero();
    fit.covariance.row(2).setZero();
    fit.covariance.col(2).setZero();
    const double of_middle = variance(*across, middle);
    const double of_turn = across->covariance(1, 1) + 0.1 * of_middle / (lever * lever);
    // The outline turns about the middle of what is seen of it.
    fit.covariance(1, 1) = of_middle + middle * middle * of_turn;
    fit.covariance(1, 2) = fit.covariance(2, 1) = -middle * of_turn;
    fit.covariance(2, 2) = of_turn;
  }
  if (along) {
    set_along(variance(*along, 0.0));
  }
}

}  // namespace luminav
