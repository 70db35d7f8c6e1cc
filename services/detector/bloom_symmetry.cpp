#include "services/detector/bloom_symmetry.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/joint_search.hpp"
#include "services/detector/opposite_sides.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kStretches = Differences::kStretches;
constexpr int kInside = Differences::kInside;
constexpr int kDistances = Differences::kDistances;
constexpr double kNoise = 3.0;           // [grey] of a stretch's mean
constexpr double kMedianNoise = 1.2;     // [grey] of the median over stretches
constexpr double kBlurError = 0.03;      // [px] by which the fall of the light may differ between sides
constexpr double kCutoff = 3.0;          // sigmas, Tukey's
constexpr double kLeastInliers = 0.5;    // of the samples, by weight
constexpr double kBloomReach = 0.05;     // [m] from a corner, beyond which a joint shows
constexpr double kUnevenBloom = 0.02;    // of the swelling, 1 sigma
constexpr double kLargestShift = 0.008;  // [m]

/// What is known of a joint along one side from beyond the fixture's corners; places as in a profile.
struct KnownJoint {
  static constexpr double kWithin = 1.5;  // [px]
  bool is_known = false;
  bool is_there = false;
  double place = 0.0;  // [px]

  [[nodiscard]] bool may_be_at(double at) const { return !is_known || (is_there && std::abs(at - place) <= kWithin); }
};
using KnownJoints = std::array<KnownJoint, 2>;  // of the positive and the negative side

struct Balance {
  double shift = 0.0;  // [m] towards the positive side
  double turn = 0.0;   // [rad]
  Eigen::Matrix2d covariance;
};

double square(double value) {
  return value * value;
}

/// A joint of the ceiling along one side, one unit high: a dark line of 12 mm, blurred.
double joint_at(double distance_px, double sigma) {
  return std::exp(-0.5 * distance_px * distance_px / (sigma * sigma));
}

/// Four numbers that one instruction works on, where the processor can.
using Four [[gnu::vector_size(4 * sizeof(double))]] = double;

/// What does not change along the sides, by distance from them.
struct Samples {
  static constexpr std::size_t kCount = 16;  // the distances, and one to fill the vectors
  static_assert(kDistances <= static_cast<int>(kCount));
  alignas(32) std::array<double, kCount> fall{};
  alignas(32) std::array<double, kCount> outwards{};
  alignas(32) std::array<double, kCount> joint{};
  alignas(32) std::array<double, kCount> variance{};
  std::array<Four, kCount> row{};  // of the regression: fall, 1, outwards, joint
};

/// Normal equations of the unknowns below: columns of the information, each filled up to two times four.
struct Sums {
  std::array<std::array<Four, 2>, 6> information{};
  std::array<Four, 2> right_side{};
  double weights = 0.0;
};

/// Adds the differences of one stretch, whose place is a share of the length; all of a side at once, and then all the
/// sums at once.
LUMINAV_VECTOR_CLONES
void add_stretch(const Samples& samples, const float* values, const bool* valid, double place, const double* solution,
                 Sums& sums) {
  constexpr std::size_t kCount = Samples::kCount;
  alignas(32) std::array<double, kCount> value{};
  for (std::size_t k = 0; k < kDistances; ++k) {
    value[k] = values[k];
  }
  alignas(32) std::array<double, kCount> tukey;
  alignas(32) std::array<double, kCount> weight;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double fall = samples.fall[k];
    const double predicted = (fall * solution[0] + (samples.outwards[k] * solution[2] + fall * place * solution[4])) +
                             (solution[1] + (samples.joint[k] * solution[3] + place * solution[5]));
    const double residual = value[k] - predicted;
    const double squared = residual * residual / (kCutoff * kCutoff * samples.variance[k]);
    const double rest = 1.0 - squared;
    tukey[k] = squared >= 1.0 ? 0.0 : rest * rest;
    weight[k] = tukey[k] / samples.variance[k];
  }
  // Of the second four, only fall x place and place are used.
  std::array<std::array<Four, 2>, 6> information = sums.information;
  for (std::size_t k = 0; k < kDistances; ++k) {
    if (!valid[k]) {
      continue;
    }
    const Four row = samples.row[k];
    const Four along = row * place;
    const Four weighted = weight[k] * row;
    const Four weighted_along = weight[k] * along;
    for (std::size_t j = 0; j < 4; ++j) {
      information[j][0] += weighted * row[j];
      information[j][1] += weighted_along * row[j];
    }
    for (std::size_t j = 0; j < 2; ++j) {
      information[4 + j][0] += weighted * along[j];
      information[4 + j][1] += weighted_along * along[j];
    }
  }
  sums.information = information;
  for (std::size_t k = 0; k < kDistances; ++k) {
    if (!valid[k]) {
      continue;
    }
    const double height = weight[k] * value[k];
    sums.right_side[0] += height * samples.row[k];
    sums.right_side[1] += height * (samples.row[k] * place);
    sums.weights += tukey[k];
  }
}

/// A shift by s [px] of the outline makes the difference 2 s x fall. A ceiling that is brighter on one side adds a
/// constant, one that grows along the sides or away from them a slope, a joint beside one of them a narrow peak. Where
/// the joint lies is tried; the fall of the light is then taken from the other side.
class Regression {
 public:
  static constexpr int kUnknowns = 6;  // shift [px], constant, outwards, joint; turn, along
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;
  using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

  Regression(const Differences& differences, double length, const KnownJoints& joints)
      : differences_(differences), joints_(joints) {
    for (std::size_t s = 0; s < kStretches; ++s) {
      place_[s] = differences.place[s] / length;
    }
  }

  std::optional<Balance> solve(double length, double step) {
    if (differences_.count < 40) {
      return std::nullopt;
    }
    take_medians();
    suppose_no_joint();
    const double cost = fit_medians();
    if (cost > kPriceOfJoint) {
      look_for_joint(cost);
    }
    fit_all();
    if (!solution_.allFinite() || weights_ < kLeastInliers * differences_.count) {
      return std::nullopt;
    }
    const Matrix covariance = information_.inverse();
    Balance balance;
    balance.shift = step * (solution_(0) + joint_pull_);
    balance.turn = step * solution_(4) / length;
    balance.covariance << step * step * (covariance(0, 0) + joint_variance_), step * step / length * covariance(0, 4),
        step * step / length * covariance(0, 4), step * step / (length * length) * covariance(4, 4);
    return balance;
  }

 private:
  static constexpr double kPriceOfJoint = 4.0;
  static constexpr double kJointPrior = 1.0 / (22.0 * 22.0);  // [1/grey^2]
  static constexpr double kTemperature = 3.0;                 // costs this much apart are e times as likely
  static constexpr double kSharpJoint = 1.15;                 // [px] 1 sigma
  static constexpr double kBluntJoint = 1.6;                  // [px] one that is not quite parallel

  void take_medians() {
    for (std::size_t k = 0; k < kDistances; ++k) {
      std::array<float, kStretches> values{};  // sorted as they come
      std::size_t count = 0;
      for (std::size_t s = 0; s < kStretches; ++s) {
        if (differences_.valid[s][k]) {
          std::size_t i = count++;
          for (; i > 0 && values[i - 1] > differences_.value[s][k]; --i) {
            values[i] = values[i - 1];
          }
          values[i] = differences_.value[s][k];
        }
      }
      has_median_[k] = 2 * count >= kStretches;
      if (has_median_[k]) {
        median_[k] = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
      }
    }
  }

  /// The mean of all places where a joint may lie, weighted by how well each explains the medians; what is known of the
  /// rest comes from the best.
  void look_for_joint(double cost_without) {
    double least = cost_without;
    double weights = 1.0;  // relative to the best so far
    double mean = solution_(0);
    double squares = 0.0;  // weighted, about the mean
    double best_at = -1.0;
    double best_sigma = 0.0;
    std::size_t best_side = 0;
    for (int half = 0; half < 2 * kDistances - 1; ++half) {
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        if (!joints_[side].may_be_at(0.5 * half)) {
          continue;
        }
        for (const double sigma : {kSharpJoint, kBluntJoint}) {
          suppose_joint(0.5 * half, sigma, side);
          const double cost = fit_medians() + kPriceOfJoint;
          if (side == 0 ? solution_(3) >= 0.0 : solution_(3) <= 0.0) {
            continue;  // joints are dark
          }
          if (cost < least) {
            const double fade = std::exp((cost - least) / kTemperature);
            weights *= fade;
            squares *= fade;
            least = cost;
            best_at = 0.5 * half;
            best_sigma = sigma;
            best_side = side;
          }
          const double weight = std::exp((least - cost) / kTemperature);
          const double off = solution_(0) - mean;
          weights += weight;
          mean += weight / weights * off;
          squares += weight * off * (solution_(0) - mean);
        }
      }
    }
    if (best_at >= 0.0) {
      suppose_joint(best_at, best_sigma, best_side);
    } else {
      suppose_no_joint();
    }
    fit_medians();
    joint_pull_ = mean - solution_(0);
    joint_variance_ = squares / weights;
  }

  void suppose_no_joint() {
    for (std::size_t k = 0; k < kDistances; ++k) {
      fall_[k] = differences_.fall[0][k] + differences_.fall[1][k];
    }
    joint_.fill(0.0);
  }

  void suppose_joint(double at, double sigma, std::size_t side) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      fall_[k] = 2.0 * differences_.fall[1 - side][k];
      joint_[k] = joint_at(static_cast<double>(k) - at, sigma);
    }
  }

  [[nodiscard]] Vector jacobian(double place, std::size_t k) const {
    Vector row;
    row << fall_[k], 1.0, static_cast<double>(k) / kDistances - 0.5, joint_[k], fall_[k] * place, place;
    return row;
  }

  /// Fits all but what varies along the sides; the robust sum of squares.
  double fit_medians() {
    using Matrix4d = Eigen::Matrix4d;
    using Vector4d = Eigen::Vector4d;
    Vector4d solution = Vector4d::Zero();
    double cost = 0.0;
    for (int pass = 0; pass < 3; ++pass) {
      Matrix4d information = Vector4d(1e-1, 1e-6, 1.0 / 36.0, kJointPrior).asDiagonal();
      Vector4d right_side = Vector4d::Zero();
      cost = 0.0;
      for (std::size_t k = 0; k < kDistances; ++k) {
        if (!has_median_[k]) {
          continue;
        }
        const Vector4d row = jacobian(0.0, k).head<4>();
        const double variance = kMedianNoise * kMedianNoise + square(kBlurError * fall_[k]);
        // Geman and McClure's weight: it has a slope everywhere
        const double squared = square(median_[k] - row.dot(solution)) / (kCutoff * kCutoff * variance);
        const double weight = (pass == 0 ? 1.0 : 1.0 / ((1.0 + squared) * (1.0 + squared))) / variance;
        information += weight * row * row.transpose();
        right_side += weight * median_[k] * row;
        cost += kCutoff * kCutoff * squared / (1.0 + squared);
      }
      solution = information.ldlt().solve(right_side);
      cost += solution(3) * solution(3) * kJointPrior + solution(2) * solution(2) / 36.0;
    }
    solution_ << solution, 0.0, 0.0;
    return cost;
  }

  void fit_all() {
    Samples samples;
    for (std::size_t k = 0; k < kDistances; ++k) {
      samples.fall[k] = fall_[k];
      samples.outwards[k] = static_cast<double>(k) / kDistances - 0.5;
      samples.joint[k] = joint_[k];
      samples.variance[k] = kNoise * kNoise + square(kBlurError * fall_[k]);
      samples.row[k] = Four{fall_[k], 1.0, samples.outwards[k], joint_[k]};
    }
    for (int pass = 0; pass < 4; ++pass) {
      Sums sums;
      Vector right_side;
      for (const auto& [i, prior] :
           {std::pair{0, 1e-1}, {1, 1e-6}, {2, 1.0 / 36.0}, {3, kJointPrior}, {4, 1e-2}, {5, 1e-4}}) {
        sums.information[i][i / 4][i % 4] = prior;
      }
      for (std::size_t s = 0; s < kStretches; ++s) {
        add_stretch(samples, differences_.value[s].data(), differences_.valid[s].data(), place_[s], solution_.data(),
                    sums);
      }
      for (int i = 0; i < kUnknowns; ++i) {
        right_side(i) = sums.right_side[i / 4][i % 4];
        for (int j = 0; j < kUnknowns; ++j) {
          information_(i, j) = sums.information[j][i / 4][i % 4];
        }
      }
      weights_ = sums.weights;
      solution_ = information_.ldlt().solve(right_side);
    }
  }

  Differences differences_;
  KnownJoints joints_;
  std::array<double, kDistances> median_{};  // [grey] of the stretches
  std::array<bool, kDistances> has_median_{};
  std::array<double, kDistances> fall_{};   // [grey] by which a shift of one pixel changes the difference
  std::array<double, kDistances> joint_{};  // its profile, 1 high
  std::array<double, kStretches> place_{};  // of the length
  Vector solution_ = Vector::Zero();
  Matrix information_;
  double weights_ = 0.0;
  double joint_pull_ = 0.0;      // [px] of the mean over joints from the best one
  double joint_variance_ = 0.0;  // [px^2] of that mean
};

std::optional<Balance> regress(const Differences& differences, double length, double step, const KnownJoints& joints) {
  return Regression(differences, length, joints).solve(length, step);
}

}  // namespace

void balance_bloom(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                   const OutlineFitParams& params, OutlineFit& fit) {
  if (outline.shape == FixtureShape::kRound) {
    return;
  }
  const Vector2d x = Vector2d::UnitX();
  const Vector2d y = Vector2d::UnitY();
  const double step = fit.metres_per_px;
  const OppositeSides sides(image, camera, outline, params.vignetting, x, y, outline.length,
                            0.5 * outline.width + fit.swelling);
  const OppositeSides ends(image, camera, outline, params.vignetting, y, x, outline.width,
                           0.5 * outline.length + fit.swelling);
  const JointSearch search{.nearest = fit.swelling - kInside * step,
                           .farthest = fit.swelling + (kDistances - kInside) * step,
                           .from_corner = kBloomReach + fit.swelling,
                           .noise = params.pixel_noise};
  Pose2 pose = fit.robot_from_outline;
  const auto known = [&](const Vector2d& line, const Vector2d& out, double length, double width) {
    const JointBeside beside =
        find_joint_beside(image, camera, {pose, outline.height, line, out, 0.5 * length, 0.5 * width}, search);
    return KnownJoint{beside.is_in_view, beside.found, (beside.middle - fit.swelling) / step + kInside};
  };
  KnownJoints side_joints{known(x, y, outline.length, outline.width), known(x, -y, outline.length, outline.width)};
  KnownJoints end_joints{known(y, x, outline.width, outline.length), known(y, -x, outline.width, outline.length)};
  const auto move = [&](KnownJoints& joints, double shift) {
    joints[0].place -= shift / step;
    joints[1].place += shift / step;
  };
  std::optional<Balance> across;
  std::optional<Balance> along;
  for (int pass = 0; pass < 3; ++pass) {
    across = regress(sides.measure(pose, step), outline.length, step, side_joints);
    along = regress(ends.measure(pose, step), outline.width, step, end_joints);
    // The edges know the direction as well: the mean of both is better than either.
    const Pose2 change{along ? along->shift : 0.0, across ? across->shift : 0.0,
                       across && pass == 0 ? 0.5 * across->turn : 0.0};
    if (std::abs(change.x) > kLargestShift || std::abs(change.y) > kLargestShift || std::abs(change.theta) > 0.02) {
      return;
    }
    pose = pose * change;
    move(side_joints, change.y);
    move(end_joints, change.x);
    if (std::hypot(change.x, change.y) < 0.03 * step) {
      break;
    }
  }
  fit.robot_from_outline = pose;
  const auto variance = [&](const Balance& balance) {
    return balance.covariance(0, 0) + std::pow(params.outline_sigma_px * step, 2) +
           std::pow(kUnevenBloom * fit.swelling, 2);
  };
  if (across) {
    const double lever = 0.3 * std::max(fit.visible_to - fit.visible_from, 0.5 * outline.width);
    fit.covariance.row(1).setZero();
    fit.covariance.col(1).setZero();
    fit.covariance.row(2).setZero();
    fit.covariance.col(2).setZero();
    fit.covariance(1, 1) = variance(*across);
    fit.covariance(2, 2) = across->covariance(1, 1) + 0.1 * variance(*across) / (lever * lever);
  }
  if (along) {
    fit.covariance.row(0).setZero();
    fit.covariance.col(0).setZero();
    fit.covariance(0, 0) = variance(*along);
  }
}

}  // namespace luminav
