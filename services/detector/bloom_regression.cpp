#include "services/detector/bloom_regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "services/detector/regression_sums.hpp"

namespace luminav {
namespace {

constexpr int kStretches = Differences::kStretches;
constexpr int kDistances = Differences::kDistances;
constexpr double kNoise = 6.0;        // [grey] of a stretch's mean, with what nothing here explains, ...
constexpr double kMostNoise = 12.0;   // ... and where more of them are off than mostly
constexpr double kMedianNoise = 1.2;  // [grey] of the median over stretches
constexpr double kBlurError = 0.03;   // [px] by which the fall of the light may differ between sides
constexpr double kCutoff = 3.0;       // sigmas, Tukey's
// Change of the difference over all distances, 1 sigma, from that of light that changes evenly over the ceiling:
constexpr double kEvenOutwardSigma = 1.5;  // [grey]
constexpr double kUnevenLight = 0.06;      // of the difference
constexpr double kOutwardSigma = 4.0;      // [grey] of the whole, where it does not change evenly
// [1/px] of the square of what the edges would have to move to make the constant difference, 1 sigma: much of the steep
// edge is cut off beside a dark ceiling, and a little of it matters little (rendered window glare).
constexpr double kUnevenEdge = 0.04;
// Of a joint that is seen beyond the corners:
constexpr double kProfileHeight = 1.25;    // of its profile in depths, which are means over some pixels
constexpr double kHeightSigma = 0.15;      // of its height ...
constexpr double kLeastHeightSigma = 1.0;  // [grey]
constexpr double kPlaceSigma = 0.5;        // [px]
constexpr double kLeastInliers = 0.5;      // of the samples, by weight
constexpr double kManyInliers = 0.7;
// Tukey's weights leave so much of samples that scatter by half of the noise, in variance by the share that is left;
// where they leave less that is more (2,280 rendered lamps: as normalised squared errors grow).
constexpr double kExpectedShare = 0.95;
constexpr double kLeastScatter = 0.28;
constexpr double kScatterOfShare = 12.0;
// [px] 1 sigma of a joint's profile, and of one that is not quite parallel
constexpr std::array<double, 2> kJointSigmas{1.15, 1.6};

constexpr double square(double value) {
  return value * value;
}

/// A joint of the ceiling along one side, one unit high: a dark line of 12 mm, blurred.
double joint_at(double distance_px, double sigma) {
  return std::exp(-0.5 * distance_px * distance_px / (sigma * sigma));
}

/// At distances of 0, 0.5, 1, ... px.
using JointProfiles = std::array<std::array<double, 2 * kDistances - 1>, kJointSigmas.size()>;

JointProfiles joint_profiles() {
  JointProfiles profiles{};
  for (std::size_t width = 0; width < profiles.size(); ++width) {
    for (std::size_t half = 0; half < profiles[width].size(); ++half) {
      profiles[width][half] = joint_at(0.5 * static_cast<double>(half), kJointSigmas[width]);
    }
  }
  return profiles;
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
    for (std::size_t k = 0; k < kDistances; ++k) {
      samples_.outwards[k] = static_cast<double>(k) / kDistances - 0.5;
    }
    samples_.precision.fill(1.0);
  }

  std::optional<Balance> solve(double length, double step) {
    if (differences_.count < Differences::kLeast) {
      return std::nullopt;
    }
    take_medians();
    suppose_no_joint();
    const double cost = suppose_even_light();
    if (cost > kPriceOfJoint) {
      look_for_joint(cost);
    }
    fit_all();
    if (!solution_.allFinite() || weights_ < kLeastInliers * differences_.count) {
      return std::nullopt;
    }
    const double share = weights_ / differences_.count;
    const Eigen::LLT<Matrix> root(information_);
    const Vector of_shift = root.solve(Vector::Unit(0));
    const Vector of_turn = root.solve(Vector::Unit(4));
    const double steepest = *std::max_element(samples_.fall.begin(), samples_.fall.end());
    Balance balance;
    // Where few lines make a stretch its noise alone costs more.
    balance.needs_joint = cost > kPriceOfJoint * OppositeSides::kMostLines / differences_.lines;
    balance.uneven_variance = step * step * square(kUnevenEdge * square(solution_(1) / std::max(steepest, 1.0)));
    balance.shift = step * (solution_(0) + joint_pull_);
    balance.turn = step * solution_(4) / length;
    const double scatter = kLeastScatter + kScatterOfShare * std::max(0.0, kExpectedShare - share);
    const double variance = step * step * (scatter * of_shift(0) + joint_variance_) + balance.uneven_variance;
    const double of_both = step * step / length * scatter * of_shift(4);
    balance.covariance << variance, of_both, of_both, step * step / (length * length) * scatter * of_turn(4);
    return balance;
  }

 private:
  /// Of how the difference changes outwards.
  struct OutwardPrior {
    double per_constant = 0.0;  // its mean, of the constant difference
    double information = 0.0;   // [1/grey^2]
  };
  static constexpr double kPriceOfJoint = 4.0;
  static constexpr double kPriceOfUneven = 3.0;
  /// Of a joint's height.
  struct JointPrior {
    double mean = 0.0;                        // [grey]
    double information = 1.0 / square(22.0);  // [1/grey^2]
  };
  static constexpr std::array<double, kUnknowns> kPriors{1e-1, 1e-6, 0.0, 0.0, 1e-2, 1e-4};
  static constexpr double kTemperature = 3.0;  // costs this much apart are e times as likely

  void take_medians() {
    SortedStretches sorted;
    sort_stretches(differences_, sorted);
    for (std::size_t k = 0; k < kDistances; ++k) {
      std::size_t count = 0;
      for (std::size_t s = 0; s < kStretches; ++s) {
        count += differences_.valid[s][k] ? 1 : 0;
      }
      has_median_[k] = 2 * count >= kStretches;
      if (has_median_[k]) {
        median_[k] = 0.5 * (sorted[(count - 1) / 2][k] + sorted[count / 2][k]);
      }
    }
  }

  /// Where the ceiling's light changes evenly, what the sides differ by says how the difference goes on outwards; where
  /// another surface lies beside one of them it does not. Fits the medians and returns the cost of the better.
  double suppose_even_light() {
    const double middles_apart = differences_.apart + kDistances - 2.0 * Differences::kInside;  // [px] of the profiles
    const OutwardPrior even{2.0 * kDistances / std::max(middles_apart, 1.0),
                            1.0 / (square(kEvenOutwardSigma) + square(kUnevenLight * level_far_out()))};
    outward_prior_ = even;
    const double cost = fit_medians();
    if (cost <= kPriceOfUneven) {
      return cost;
    }
    const Vector even_solution = solution_;
    outward_prior_ = {0.0, 1.0 / square(kOutwardSigma)};
    const double cost_uneven = fit_medians() + kPriceOfUneven;
    if (cost_uneven < cost) {
      return cost_uneven;
    }
    outward_prior_ = even;
    solution_ = even_solution;
    return cost;
  }

  /// By what the sides differ far from them [grey].
  [[nodiscard]] double level_far_out() const {
    constexpr std::size_t kFar = 4;  // distances
    double level = 0.0;
    for (std::size_t k = kDistances - kFar; k < kDistances; ++k) {
      level += has_median_[k] ? median_[k] / kFar : 0.0;
    }
    return level;
  }

  /// The mean of all places where a joint may lie, weighted by how well each explains the medians; what is known of the
  /// rest comes from the best.
  void look_for_joint(double cost_without) {
    if (joints_[0].is_ruled_out() && joints_[1].is_ruled_out()) {
      return;
    }
    const Vector solution_without = solution_;
    double least = cost_without;
    double weights = 1.0;  // relative to the best so far
    double mean = solution_(0);
    double squares = 0.0;  // weighted, about the mean
    int best_half = -1;
    std::size_t best_width = 0;
    std::size_t best_side = 0;
    for (int half = 0; half < 2 * kDistances - 1; ++half) {
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        if (!joints_[side].may_be_at(0.5 * half)) {
          continue;
        }
        for (std::size_t width = 0; width < kJointSigmas.size(); ++width) {
          suppose_joint(half, width, side);
          const double cost = fit_medians() + price_of_joint(half, joints_[side]);
          if (side == 0 ? solution_(3) >= 0.0 : solution_(3) <= 0.0) {
            continue;  // joints are dark
          }
          if (cost < least) {
            const double fade = std::exp((cost - least) / kTemperature);
            weights *= fade;
            squares *= fade;
            least = cost;
            best_half = half;
            best_width = width;
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
    if (best_half >= 0) {
      suppose_joint(best_half, best_width, best_side);
      fit_medians();
    } else {
      suppose_no_joint();
      solution_ = solution_without;
    }
    joint_pull_ = mean - solution_(0);
    joint_variance_ = squares / weights;
  }

  /// One that is seen costs nothing but for another place. `half` [0.5 px].
  static double price_of_joint(int half, const KnownJoint& joint) {
    return joint.is_seen() ? square((0.5 * half - joint.place) / kPlaceSigma) : kPriceOfJoint;
  }

  static JointPrior prior_of(const KnownJoint& joint, std::size_t side) {
    if (!joint.is_seen()) {
      return {};
    }
    const double height = kProfileHeight * joint.depth;
    return {side == 0 ? -height : height, 1.0 / square(kHeightSigma * height + kLeastHeightSigma)};
  }

  void suppose_no_joint() {
    joint_prior_ = {};
    for (std::size_t k = 0; k < kDistances; ++k) {
      samples_.fall[k] = differences_.fall[0][k] + differences_.fall[1][k];
    }
    samples_.joint.fill(0.0);
    samples_.fill_rows();
    take_precisions(kMedianNoise);
  }

  /// `half` [0.5 px] from the first distance.
  void suppose_joint(int half, std::size_t width, std::size_t side) {
    static const JointProfiles kProfiles = joint_profiles();
    joint_prior_ = prior_of(joints_[side], side);
    for (int k = 0; k < kDistances; ++k) {
      const auto i = static_cast<std::size_t>(k);
      samples_.fall[i] = 2.0 * differences_.fall[1 - side][i];
      samples_.joint[i] = kProfiles[width][static_cast<std::size_t>(std::abs(2 * k - half))];
    }
    samples_.fill_rows();
    take_precisions(kMedianNoise);
  }

  void take_precisions(double noise) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      samples_.precision[k] = 1.0 / (noise * noise + square(kBlurError * samples_.fall[k]));
    }
  }

  /// To the sums of both kinds.
  template <typename Sums>
  void add_priors(Sums& sums) const {
    for (std::size_t i = 0; i < 4; ++i) {
      sums.information[i][i] = kPriors[i];
    }
    // Where the ceiling's light changes evenly, what it differs by on the sides says how it goes on outwards.
    sums.information[1][1] += square(outward_prior_.per_constant) * outward_prior_.information;
    sums.information[1][2] = sums.information[2][1] = -outward_prior_.per_constant * outward_prior_.information;
    sums.information[2][2] = outward_prior_.information;
    sums.information[3][3] = joint_prior_.information;
    sums.right_side[3] = joint_prior_.information * joint_prior_.mean;
  }

  /// Fits all but what varies along the sides; the robust sum of squares.
  double fit_medians() {
    using Matrix4d = Eigen::Matrix4d;
    using Vector4d = Eigen::Vector4d;
    Vector4d solution = Vector4d::Zero();
    double cost = 0.0;
    for (int pass = 0; pass < 3; ++pass) {
      MedianSums sums;
      add_priors(sums);
      sums.add(samples_, median_, has_median_, solution.data(), kCutoff, pass == 0);
      Matrix4d information;
      Vector4d right_side;
      for (int i = 0; i < 4; ++i) {
        right_side(i) = sums.right_side[i];
        for (int j = 0; j < 4; ++j) {
          information(i, j) = sums.information[static_cast<std::size_t>(j)][i];
        }
      }
      solution = information.inverse() * right_side;
      cost = sums.cost + (square(solution(3) - joint_prior_.mean) * joint_prior_.information +
                          square(solution(2) - outward_prior_.per_constant * solution(1)) * outward_prior_.information);
    }
    solution_ << solution, 0.0, 0.0;
    return cost;
  }

  /// From the medians' solution on. Where many differences are off from what it explains, as beside a window, those
  /// that are off by more say as much as the few that agree.
  void fit_all() {
    const Vector of_medians = solution_;
    for (double noise = kNoise; noise <= kMostNoise; noise *= 2.0) {
      solution_ = of_medians;
      fit_all_within(noise);
      if (!solution_.allFinite() || weights_ >= kManyInliers * differences_.count) {
        return;
      }
    }
  }

  /// By two steps, which leave little (rendered frames: as accurate as four). `noise` [grey] of a stretch's mean.
  void fit_all_within(double noise) {
    take_precisions(noise);
    for (int pass = 0; pass < 2; ++pass) {
      RegressionSums sums;
      add_priors(sums);
      sums.corner[0][0] = kPriors[4];
      sums.corner[1][1] = kPriors[5];
      for (std::size_t s = 0; s < kStretches; ++s) {
        sums.add_stretch(samples_, differences_.value[s].data(), differences_.valid[s].data(), place_[s],
                         solution_.data(), kCutoff);
      }
      Vector right_side;
      for (int i = 0; i < 4; ++i) {
        right_side(i) = sums.right_side[i];
        for (int j = 0; j < 4; ++j) {
          information_(i, j) = sums.information[static_cast<std::size_t>(j)][i];
        }
      }
      for (int i = 0; i < 2; ++i) {
        const auto column = static_cast<std::size_t>(i);
        right_side(4 + i) = sums.right_side_along[i];
        for (int j = 0; j < 4; ++j) {
          information_(4 + i, j) = information_(j, 4 + i) = sums.along[column][j];
        }
        for (int j = 0; j < 2; ++j) {
          information_(4 + j, 4 + i) = sums.corner[column][j];
        }
      }
      weights_ = sums.weights;
      solution_ = information_.llt().solve(right_side);
    }
  }

  const Differences& differences_;
  KnownJoints joints_;
  std::array<double, RegressionSamples::kCount> median_{};  // [grey] of the stretches
  std::array<bool, RegressionSamples::kCount> has_median_{};
  RegressionSamples samples_;
  OutwardPrior outward_prior_;
  JointPrior joint_prior_;
  std::array<double, kStretches> place_{};  // of the length
  Vector solution_ = Vector::Zero();
  Matrix information_;
  double weights_ = 0.0;
  double joint_pull_ = 0.0;      // [px] of the mean over joints from the best one
  double joint_variance_ = 0.0;  // [px^2] of that mean
};

}  // namespace

std::optional<Balance> balance_sides(const Differences& differences, double length, double step,
                                     const KnownJoints& joints) {
  return Regression(differences, length, joints).solve(length, step);
}

}  // namespace luminav
