#include "services/detector/bloom_edges.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "services/detector/column_sort.hpp"
#include "services/detector/edge_means.hpp"
#include "services/detector/pixel_sampling.hpp"
#include "services/detector/side_sums.hpp"

namespace luminav {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Eigen::Vector2d;

constexpr std::size_t kMostPoints = 240;  // the long and the short sides of a large one
constexpr double kSpacing = 8.0;          // [px] ...
constexpr double kLeastSpacing = 4.0;     // ... of short sides, whose ceiling few points may miss in window glare, ...
constexpr int kEnough = 24;               // ... up to so many points
constexpr double kCorner = 6.0;           // [px] from a corner nothing is measured
constexpr double kBeyondBloom = 14.0;     // [px] from there to the middle of where the ceiling is taken
constexpr std::size_t kDistances = 6;     // 2 px apart
constexpr double kLevel = 0.8;            // of the way from the ceiling to saturation
constexpr double kWhite = 255.0;
constexpr double kUnevenGuess = 0.3;   // of the swelling's own deviation: where one side alone is seen it is a guess
constexpr double kOneSideBloom = 0.3;  // [px] 1 sigma: the ends' bloom is that of a side no better (simulated pictures)
constexpr double kUnevenBloom = 0.03;  // of the swelling, 1 sigma
// [1/m] of the swelling, 1 sigma: its change along a fixture that is cut (0.17 to 0.22, simulated pictures)
constexpr double kTaperOfBloom = 0.2;
constexpr double kLeastSwelling = 0.002;  // [m] that it is reckoned from
constexpr double kNoTaper = 1e-5;         // [m/m]
constexpr double kSettled = 0.3;          // [px] of a move: it would be measured the same again
constexpr double kCutoff = 1.5;           // [px] Tukey's

struct EdgePoint {
  Vector2d place;   // [m] outline frame
  Vector2d normal;  // outward
  int side = 0;
  Vector2d pixel;      // of the swollen outline
  Vector2d normal_px;  // of length 1
  double metres_per_px = 0.0;
  bool in_view = false;
};

/// Some of the points.
class SomePoints {
 public:
  using AllMeans = std::array<EdgeMeans::Means, kMostPoints>;

  void add(std::size_t index, const EdgePoint& point) {
    places_[count_] = {point.pixel, point.normal_px};
    indices_[count_++] = index;
  }
  [[nodiscard]] std::span<const std::size_t> indices() const { return {indices_.data(), count_}; }
  /// In the order in which the points were added.
  void sample(const GreyView& image, const EdgeMeans::Distances& distances, AllMeans& means) const {
    sample_edge_means(image, {places_.data(), count_}, distances, means.data());
  }

 private:
  std::array<EdgeMeans::Place, kMostPoints> places_;
  std::array<std::size_t, kMostPoints> indices_;
  std::size_t count_ = 0;
};

struct Bloom {
  double swelling = 0.0;  // [m]
  double taper = 0.0;     // [m/m] change of that along the long sides
};

struct Solution {
  Matrix5d information;  // along, across, theta, swelling, taper; per edge_sigma squared
  double residual_px = 0.0;
};

struct Line {  // level along a side: value at the middle, slope per metre
  double level = 0.0;
  double slope = 0.0;
  bool is_seen = false;
};

/// Of those that are numbers; 0 where there is none.
double median_of_found(std::span<const double> offsets) {
  std::array<double, kMostPoints> found;
  const auto end = std::copy_if(offsets.begin(), offsets.end(), found.begin(), [](double o) { return !std::isnan(o); });
  if (end == found.begin()) {
    return 0.0;
  }
  const auto middle = found.begin() + (end - found.begin()) / 2;
  std::nth_element(found.begin(), middle, end);
  return *middle;
}

class BloomLevel {
 public:
  BloomLevel(const GreyView& image, const CeilingCamera& camera, const Outline& outline, double vignetting)
      : image_(image), camera_(camera), outline_(outline), vignetting_(vignetting) {}

  bool refine(const OutlineFitParams& params, OutlineFit& fit) {
    place_points();
    middle_ = 0.5 * (fit.visible_from + fit.visible_to);
    // Towards both ends of a fixture bloom is the same, and one side cannot tell its change from a turn.
    const bool both_ends = fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd);
    taper_sigma_ = both_ends || fit.only_side() ? kNoTaper : kTaperOfBloom * std::max(fit.swelling, kLeastSwelling);
    Bloom bloom{fit.swelling, 0.0};
    Pose2 pose = fit.robot_from_outline;
    project(pose, bloom);
    if (!measure_ceiling()) {
      return false;
    }
    std::optional<Solution> solution;
    for (int pass = 0; pass < 2; ++pass) {
      const Pose2 before = pose;
      if (pass > 0) {
        project(pose, bloom);
      }
      solution = step(params, pose, bloom);
      if (!solution) {
        return false;
      }
      const double moved = distance(before, pose) + 0.5 * outline_.length * std::abs(pose.theta - before.theta);
      if (moved < kSettled * metres_per_px_) {
        break;
      }
    }
    fit.robot_from_outline = pose;
    fit.swelling = bloom.swelling;
    fit.residual_px = solution->residual_px;
    take_covariance(params, *solution, fit);
    return true;
  }

 private:
  void place_points() {
    metres_per_px_ = (outline_.height - camera_.mounting().z) / camera_.intrinsics().fx;
    const auto add = [&](int side, const Vector2d& middle, const Vector2d& along, const Vector2d& normal,
                         double extent) {
      const double usable = extent - 2.0 * std::min(kCorner * metres_per_px_, 0.2 * extent);
      const auto fitting = [&](double apart_px) { return static_cast<int>(usable / (apart_px * metres_per_px_)); };
      const int count = std::clamp(std::max(fitting(kSpacing), std::min(fitting(kLeastSpacing), kEnough)), 4, 60);
      for (int i = 0; i < count && count_ < kMostPoints; ++i) {
        EdgePoint& point = points_[count_++];
        point.place = middle + usable * ((i + 0.5) / count - 0.5) * along;
        point.normal = normal;
        point.side = side;
      }
      first_of_side_[static_cast<std::size_t>(side) + 1] = count_;
    };
    const Vector2d x = Vector2d::UnitX();
    const Vector2d y = Vector2d::UnitY();
    add(kLeftSide, 0.5 * outline_.width * y, x, y, outline_.length);
    add(kRightSide, -0.5 * outline_.width * y, x, -y, outline_.length);
    add(kFarEnd, 0.5 * outline_.length * x, y, x, outline_.width);
    add(kNearEnd, -0.5 * outline_.length * x, y, -x, outline_.width);
  }

  void project(const Pose2& pose, const Bloom& bloom) {
    constexpr double kAhead = 0.02;  // [m]
    const PointTransform to_robot(pose);
    std::array<Vector2d, 2 * kMostPoints> places;
    std::array<Vector2d, 2 * kMostPoints> pixels;
    for (std::size_t i = 0; i < count_; ++i) {
      const EdgePoint& point = points_[i];
      const Vector2d on_edge = point.place + (bloom.swelling + bloom.taper * along_side(point)) * point.normal;
      places[2 * i] = to_robot * on_edge;
      places[2 * i + 1] = to_robot * (on_edge + kAhead * point.normal);
    }
    camera_.pixels_of_ceiling_points({places.data(), 2 * count_}, outline_.height, {pixels.data(), 2 * count_});
    for (std::size_t i = 0; i < count_; ++i) {
      EdgePoint& point = points_[i];
      const Vector2d& pixel = pixels[2 * i];
      const Vector2d& ahead = pixels[2 * i + 1];
      point.in_view = pixel.allFinite() && ahead.allFinite();
      if (point.in_view) {
        const double step = (ahead - pixel).norm();
        point.pixel = pixel;
        point.normal_px = (ahead - pixel) / step;
        point.metres_per_px = kAhead / step;
        point.in_view = is_sampled(image_, pixel + (kBloomSearch + 1) * point.normal_px) &&
                        is_sampled(image_, pixel - (kBloomSearch + 1) * point.normal_px);
      }
    }
  }

  /// Share of the light that the lens lets through there.
  [[nodiscard]] double gain_at(const Vector2d& pixel) const {
    const Vector2d size(image_.width, image_.height);
    return 1.0 - vignetting_ * (pixel - 0.5 * size).squaredNorm() / (0.25 * size.squaredNorm());
  }

  /// How far along a long side from the middle of what is seen [m]; an end's bloom is taken for that in the middle.
  [[nodiscard]] double along_side(const EdgePoint& point) const {
    return point.side == kLeftSide || point.side == kRightSide ? point.place.x() - middle_ : 0.0;
  }

  static double coordinate(const EdgePoint& point) {
    return point.side == kLeftSide || point.side == kRightSide ? point.place.x() : point.place.y();
  }

  /// The ceiling beside each side, from beyond its bloom, as a line along it; false when no side shows it. The median
  /// over distances of the medians along the side: a joint of the ceiling may run along it.
  bool measure_ceiling() {
    std::array<std::size_t, kSides> counts{};
    SomePoints seen;
    for (std::size_t i = 0; i < count_; ++i) {
      const EdgePoint& point = points_[i];
      if (point.in_view && is_sampled(image_, point.pixel + (kBeyondBloom + 2.0 * kDistances) * point.normal_px)) {
        seen.add(i, point);
        ++counts[static_cast<std::size_t>(point.side)];
      }
    }
    EdgeMeans::Distances distances;
    for (std::size_t k = 0; k < distances.size(); ++k) {
      distances[k] = kBeyondBloom - (kDistances - 1.0) + 2.0 * static_cast<double>(std::min(k, kDistances - 1));
    }
    SomePoints::AllMeans means;
    seen.sample(image_, distances, means);
    std::span<EdgeMeans::Means> not_taken(means);  // side after side
    double mean = 0.0;
    int sides = 0;
    for (std::size_t side = 0; side < kSides; ++side) {
      const std::span<EdgeMeans::Means> of_side = not_taken.first(counts[side]);
      not_taken = not_taken.subspan(counts[side]);
      ceiling_[side].is_seen = of_side.size() >= 4;
      if (!ceiling_[side].is_seen) {
        continue;
      }
      sort_columns(of_side);
      std::array<float, kDistances> at_distance;
      std::copy_n(of_side[of_side.size() / 2].begin(), kDistances, at_distance.begin());
      std::sort(at_distance.begin(), at_distance.end());
      ceiling_[side].level = 0.5 * (at_distance[kDistances / 2] + at_distance[kDistances / 2 - 1]);
      mean += ceiling_[side].level;
      ++sides;
    }
    if (sides == 0) {
      return false;
    }
    mean /= sides;
    height_ = kLevel * (kWhite - mean);
    // From beyond the bloom to the edge, by the slope between opposite sides.
    const double beyond = kBeyondBloom * metres_per_px_;
    const auto carry = [&](std::size_t a, std::size_t b, double apart) {
      if (ceiling_[a].is_seen && ceiling_[b].is_seen) {
        const double inward = beyond * (ceiling_[a].level - ceiling_[b].level) / (apart + 2.0 * beyond);
        ceiling_[a].level -= inward;
        ceiling_[b].level += inward;
      } else if (ceiling_[a].is_seen || ceiling_[b].is_seen) {
        ceiling_[ceiling_[a].is_seen ? b : a].level = ceiling_[ceiling_[a].is_seen ? a : b].level;
      } else {
        ceiling_[a].level = ceiling_[b].level = mean;
      }
    };
    const double across = ceiling_[kLeftSide].level - ceiling_[kRightSide].level;
    const double along = ceiling_[kFarEnd].level - ceiling_[kNearEnd].level;
    if (ceiling_[kLeftSide].is_seen && ceiling_[kRightSide].is_seen) {
      const double slope = across / (outline_.width + 2.0 * beyond);
      ceiling_[kFarEnd].slope = ceiling_[kNearEnd].slope = slope;
    }
    if (ceiling_[kFarEnd].is_seen && ceiling_[kNearEnd].is_seen) {
      const double slope = along / (outline_.length + 2.0 * beyond);
      ceiling_[kLeftSide].slope = ceiling_[kRightSide].slope = slope;
    }
    carry(kLeftSide, kRightSide, outline_.width);
    carry(kFarEnd, kNearEnd, outline_.length);
    return true;
  }

  [[nodiscard]] double level_at(const EdgePoint& point) const {
    const Line& ceiling = ceiling_[static_cast<std::size_t>(point.side)];
    return ceiling.level + ceiling.slope * coordinate(point) + height_ * gain_at(point.pixel);
  }

  /// Distance [px] beyond the swollen outline at which the light falls to `level`, the nearest such place; `means` are
  /// 1 px apart from `first` on.
  static std::optional<double> crossing(std::span<const float> means, int first, double level) {
    std::optional<double> nearest;
    float before = means[0];
    for (std::size_t i = 1; i < means.size(); ++i) {
      const float here = means[i];
      if (before >= level && here < level) {
        const double at = first + static_cast<int>(i) - 1 + (before - level) / (before - here);
        if (!nearest || std::abs(at) < std::abs(*nearest)) {
          nearest = at;
        }
      }
      before = here;
    }
    return nearest;
  }

  /// Where the light crosses its level at each point; not a number where it does not or is out of view. Mostly that is
  /// near the edge: the rest of a profile is looked at only where it is not.
  void find_crossings(std::array<double, kMostPoints>& offsets) const {
    constexpr EdgeMeans::Distances kNear{-4, -3, -2, -1, 0, 1, 2, 3};
    constexpr EdgeMeans::Distances kFar{-6, -5, 4, 5, 6, 6, 6, 6};
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    offsets.fill(kNothing);
    SomePoints seen;
    for (std::size_t i = 0; i < count_; ++i) {
      if (points_[i].in_view) {
        seen.add(i, points_[i]);
      }
    }
    SomePoints::AllMeans near_means;
    seen.sample(image_, kNear, near_means);
    SomePoints open;
    std::array<std::array<float, 2 * kBloomSearch + 1>, kMostPoints> profiles;
    for (std::size_t n = 0; n < seen.indices().size(); ++n) {
      const std::size_t i = seen.indices()[n];
      const auto nearest = crossing(near_means[n], -4, level_at(points_[i]));
      if (nearest && std::abs(*nearest) <= 3.0) {
        offsets[i] = *nearest;
        continue;
      }
      std::copy(near_means[n].begin(), near_means[n].end(), profiles[open.indices().size()].begin() + 2);
      open.add(i, points_[i]);
    }
    SomePoints::AllMeans far_means;
    open.sample(image_, kFar, far_means);
    for (std::size_t n = 0; n < open.indices().size(); ++n) {
      std::copy_n(far_means[n].begin(), 2, profiles[n].begin());
      std::copy_n(far_means[n].begin() + 2, 3, profiles[n].end() - 3);
      const std::size_t i = open.indices()[n];
      offsets[i] = crossing(profiles[n], -kBloomSearch, level_at(points_[i])).value_or(kNothing);
    }
  }

  std::optional<Solution> step(const OutlineFitParams& params, Pose2& pose, Bloom& bloom) const {
    const double sigma = params.edge_sigma_px * metres_per_px_;
    const double free_along = std::max(outline_.length, outline_.width);
    OutlineEquations equations;
    Matrix5d& information = equations.information;
    information(0, 0) = information(1, 1) = sigma * sigma / (free_along * free_along);
    information(2, 2) = sigma * sigma / (kPi * kPi);
    information(3, 3) = sigma * sigma / (params.swelling_sigma * params.swelling_sigma);
    information(4, 4) = sigma * sigma / (taper_sigma_ * taper_sigma_);
    Vector5d& right_side = equations.right_side;
    right_side(3) = -information(3, 3) * bloom.swelling;
    right_side(4) = -information(4, 4) * bloom.taper;
    std::array<double, kMostPoints> offsets;
    find_crossings(offsets);
    // Judged against their side's median: the fit before may have been off by a side's width of error.
    std::array<double, kSides> centre{};
    for (std::size_t side = 0; side < kSides; ++side) {
      centre[side] = median_of_found(
          std::span(offsets).subspan(first_of_side_[side], first_of_side_[side + 1] - first_of_side_[side]));
    }
    std::array<SideSums, kSides> sums{};
    double squares = 0.0;
    int used = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const EdgePoint& point = points_[i];
      const auto side = static_cast<std::size_t>(point.side);
      const double offset = offsets[i];
      const double ratio = (offset - centre[side]) / kCutoff;
      if (!(std::abs(ratio) < 1.0)) {  // or not found
        continue;
      }
      const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
      sums[side].add(weight, coordinate(point), offset * point.metres_per_px);
      squares += weight * ratio * ratio;
      ++used;
    }
    double weights = 0.0;
    for (std::size_t side = 0; side < kSides; ++side) {
      const bool is_long = side == kLeftSide || side == kRightSide;
      sums[side].add_to(equations, static_cast<int>(side), is_long ? -middle_ : 0.0);
      weights += sums[side].weights;
    }
    if (used < 12) {
      return std::nullopt;
    }
    const Vector5d change = information.llt().solve(right_side);
    if (!change.allFinite() || change.head<2>().norm() > 0.05 || std::abs(change(2)) > 0.05) {
      return std::nullopt;
    }
    pose = pose * Pose2{change(0), change(1), change(2)};
    bloom.swelling += change(3);
    bloom.taper += change(4);
    return Solution{information, kCutoff * std::sqrt(squares / weights)};
  }

  void take_covariance(const OutlineFitParams& params, const Solution& solution, OutlineFit& fit) const {
    const double edge_sigma = std::max(params.edge_sigma_px, solution.residual_px) * metres_per_px_;
    const Matrix5d inverse = solution.information.llt().solve(Matrix5d::Identity());
    fit.covariance = edge_sigma * edge_sigma * inverse.topLeftCorner<3, 3>();
    // What bloom does not do alike on all sides grows with its reach.
    const double unknown = edge_sigma * std::sqrt(inverse(3, 3));
    const double shared =
        std::hypot(params.outline_sigma_px * metres_per_px_, kUnevenBloom * fit.swelling, kUnevenGuess * unknown);
    const double lever = 0.3 * std::max(fit.visible_to - fit.visible_from, 0.5 * outline_.width);
    fit.covariance(0, 0) += shared * shared;
    fit.covariance(1, 1) += shared * shared;
    fit.covariance(2, 2) += 0.1 * shared * shared / (lever * lever);
    if (fit.only_side()) {
      fit.covariance(1, 1) += std::pow(kOneSideBloom * metres_per_px_, 2);
      fit.covariance(2, 2) += kOneSideTaper * kOneSideTaper;
    }
  }

  const GreyView& image_;
  const CeilingCamera& camera_;
  const Outline& outline_;
  double vignetting_;
  std::array<EdgePoint, kMostPoints> points_;
  std::size_t count_ = 0;
  std::array<std::size_t, kSides + 1> first_of_side_{};  // of the points
  double metres_per_px_ = 0.0;
  double middle_ = 0.0;       // [m] along the outline, of what is seen of it
  double taper_sigma_ = 0.0;  // [m/m]
  std::array<Line, kSides> ceiling_{};
  double height_ = 0.0;  // [grey] above the ceiling at which the edge is taken
};

}  // namespace

void level_bloom(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                 const OutlineFitParams& params, OutlineFit& fit) {
  if (outline.shape == FixtureShape::kRound) {
    return;
  }
  BloomLevel(image, camera, outline, params.vignetting).refine(params, fit);
}

}  // namespace luminav
