#include "services/detector/outline_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Eigen::Vector2d;

constexpr int kLongestProfile = 64;  // [px]
constexpr int kLeastPoints = 6;
constexpr double kCornerStretch = 0.36;     // of the length, from the middle: beyond it a long side is next to its end
constexpr double kLargestSideOffset = 3.2;  // [px] a joint of 12 mm, 2.5 m away
constexpr double kJointSigma = 0.0045;      // [m] of an unlit fixture's end: it may be a joint's edge, 12 mm wide
constexpr double kFaintest = 0.4;           // of the mean step: fainter ones belong to something else

double tukey_weight(double residual, double cutoff) {
  const double ratio = residual / cutoff;
  const double rest = 1.0 - ratio * ratio;
  return rest <= 0.0 ? 0.0 : rest * rest;
}

/// True when a side in view shows so few edges that the outline cannot be there: most guesses end here, early.
bool is_hopeless(const OutlineFit& fit) {
  constexpr double kLeastShare = 0.45;
  for (const int side : {kLeftSide, kRightSide}) {
    if (fit.in_view[static_cast<std::size_t>(side)] >= 5 && fit.share(side) < kLeastShare) {
      return true;
    }
  }
  return false;
}

struct Pass {
  int search_px;
  double cutoff_px;
};

}  // namespace

double OutlineFit::share(int side) const {
  const auto s = static_cast<std::size_t>(side);
  return in_view[s] == 0 ? 0.0 : static_cast<double>(on_edge[s]) / in_view[s];
}

bool OutlineFit::end_visible(int side) const {
  const auto s = static_cast<std::size_t>(side);
  return expected[s] > 0 && in_view[s] >= 3 && 2 * in_view[s] >= expected[s];
}

double OutlineFit::quality() const {
  int all = 0;
  int good = 0;
  for (std::size_t side = 0; side < kSides; ++side) {
    all += in_view[side];
    good += on_edge[side];
  }
  return all == 0 ? 0.0 : static_cast<double>(good) / all;
}

void OutlineFitter::place_points(const Outline& outline, double metres_per_px, double spacing_px) {
  points_.clear();
  if (outline.shape == FixtureShape::kRound) {
    const double radius = 0.5 * outline.length;
    const int count = std::clamp(static_cast<int>(2.0 * kPi * radius / (metres_per_px * spacing_px)), 16, 64);
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * kPi * i / count;
      const Vector2d normal(std::cos(angle), std::sin(angle));
      points_.push_back({.place = radius * normal, .normal = normal, .side = kLeftSide});
    }
    return;
  }
  const auto add_side = [&](int side, const Vector2d& middle, const Vector2d& along, const Vector2d& normal,
                            double extent) {
    // corners are rounded by blur and bloom: keep away from them
    const double usable = extent - 2.0 * std::min(0.12 * extent, 5.0 * metres_per_px);
    const int count = std::clamp(static_cast<int>(usable / (metres_per_px * spacing_px)), 5, 48);
    for (int i = 0; i < count; ++i) {
      const double t = usable * ((i + 0.5) / count - 0.5);
      points_.push_back({.place = middle + t * along, .normal = normal, .side = side});
    }
  };
  const double half_length = 0.5 * outline.length;
  const double half_width = 0.5 * outline.width;
  const Vector2d x = Vector2d::UnitX();
  const Vector2d y = Vector2d::UnitY();
  add_side(kLeftSide, half_width * y, x, y, outline.length);
  add_side(kRightSide, -half_width * y, x, -y, outline.length);
  add_side(kFarEnd, half_length * x, y, x, outline.width);
  add_side(kNearEnd, -half_length * x, y, -x, outline.width);
}

void OutlineFitter::measure(const GreyView& image, const Outline& outline, const OutlineFitParams& params,
                            const Pose2& pose, double swelling, double taper, const Sampling& sampling) {
  const int search = sampling.search_px;
  const int half_filter = sampling.half_filter;
  const int lines = sampling.lines;
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  const double threshold = std::max(
      sampling.least_edge, 2.5 * params.pixel_noise * std::sqrt(2.0 / static_cast<double>(half_filter * lines)));
  const float sign = params.inside_brighter ? 1.0F : -1.0F;
  const int reach = std::min(search + half_filter, kLongestProfile / 2 - 1);
  const int length = 2 * reach + 1;
  std::array<float, kLongestProfile> profile;
  std::array<float, kLongestProfile + 1> sums;
  std::array<float, kLongestProfile> response;

  if (!params.inside_brighter) {
    for (auto& mean : side_profiles_) {
      mean.fill(0.0F);
    }
  }
  for (Point& point : points_) {
    point.in_view = false;
    point.found = false;
    const Vector2d on_outline = point.place + (swelling + taper * point.place.x()) * point.normal;
    const Vector2d in_robot(pose.x + c * on_outline.x() - s * on_outline.y(),
                            pose.y + s * on_outline.x() + c * on_outline.y());
    constexpr double kAhead = 0.02;  // [m] to find the normal's direction in the image
    const Vector2d normal_in_robot(c * point.normal.x() - s * point.normal.y(),
                                   s * point.normal.x() + c * point.normal.y());
    const auto pixel = camera_->pixel_of_ceiling_point(in_robot, outline.height);
    const auto ahead = camera_->pixel_of_ceiling_point(in_robot + kAhead * normal_in_robot, outline.height);
    if (!pixel || !ahead) {
      continue;
    }
    const double px_per_step = (*ahead - *pixel).norm();
    if (px_per_step < 1e-6) {
      continue;
    }
    const Vector2d normal_px = (*ahead - *pixel) / px_per_step;
    const Vector2d along_px(-normal_px.y(), normal_px.x());
    const Vector2d far_corner = reach * normal_px + 0.5 * (lines - 1) * along_px;
    const Vector2d near_corner = reach * normal_px - 0.5 * (lines - 1) * along_px;
    if (!is_sampled(image, *pixel + far_corner) || !is_sampled(image, *pixel + near_corner) ||
        !is_sampled(image, *pixel - far_corner) || !is_sampled(image, *pixel - near_corner)) {
      continue;
    }
    point.in_view = true;

    std::fill_n(profile.begin(), length, 0.0F);
    for (int line = 0; line < lines; ++line) {
      const Vector2d start = *pixel + (line - 0.5 * (lines - 1)) * along_px - reach * normal_px;
      auto x = static_cast<float>(start.x());
      auto y = static_cast<float>(start.y());
      const auto dx = static_cast<float>(normal_px.x());
      const auto dy = static_cast<float>(normal_px.y());
      for (int k = 0; k < length; ++k) {
        profile[static_cast<std::size_t>(k)] += bilinear(image, x, y);
        x += dx;
        y += dy;
      }
    }
    if (!params.inside_brighter) {
      std::array<float, kLongestProfile>& mean = side_profiles_[static_cast<std::size_t>(point.side)];
      for (int k = 0; k < length; ++k) {
        mean[static_cast<std::size_t>(k)] += profile[static_cast<std::size_t>(k)];
      }
    }
    sums[0] = 0.0F;
    for (int k = 0; k < length; ++k) {
      sums[static_cast<std::size_t>(k) + 1] = sums[static_cast<std::size_t>(k)] + profile[static_cast<std::size_t>(k)];
    }
    // difference of the means of half_filter pixels inside and outside of the boundary before pixel k
    const float scale = sign / static_cast<float>(half_filter * lines);
    int best = -1;
    float best_score = 0.0F;
    const int last = length - half_filter;
    for (int k = half_filter; k <= last; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const auto h = static_cast<std::size_t>(half_filter);
      response[i] = scale * (2.0F * sums[i] - sums[i - h] - sums[i + h]);
      // of two edges of the same height, the nearer to the prediction
      const float score = response[i] * (1.0F - 0.02F * std::abs(static_cast<float>(k - reach) - 0.5F));
      if (score > best_score) {
        best_score = score;
        best = k;
      }
    }
    if (best <= half_filter || best >= last || response[static_cast<std::size_t>(best)] < threshold) {
      continue;
    }
    const double before = response[static_cast<std::size_t>(best) - 1];
    const double at = response[static_cast<std::size_t>(best)];
    const double after = response[static_cast<std::size_t>(best) + 1];
    const double curvature = before - 2.0 * at + after;
    const double vertex = curvature < -1e-6 ? std::clamp(0.5 * (before - after) / curvature, -1.0, 1.0) : 0.0;
    point.found = true;
    point.offset_px = best - 0.5 - reach + vertex;
    point.metres_per_px = kAhead / px_per_step;
    point.offset = point.offset_px * point.metres_per_px;
    point.step = at;
  }
  if (!params.inside_brighter) {
    take_joints_off(reach);
  }
}

/// An unlit fixture often ends at a joint of the ceiling, which is darker still: then the strongest edge is the joint's
/// far one, a joint's width outside of the fixture. The mean profile of a side shows it: before the step up there is
/// one further down, from the fixture to the joint.
void OutlineFitter::take_joints_off(int reach) {
  constexpr int kFilter = 2;       // [px] narrower than a joint
  constexpr int kWidestJoint = 6;  // [px]
  constexpr double kShare = 0.35;  // of the step up
  const int length = 2 * reach + 1;
  for (int side = 0; side < kSides; ++side) {
    const auto& profile = side_profiles_[static_cast<std::size_t>(side)];
    std::array<double, kLongestProfile> rise{};
    int outer = -1;
    for (int k = kFilter; k + kFilter <= length; ++k) {
      const auto i = static_cast<std::size_t>(k);
      rise[i] = 0.5 * (profile[i] + profile[i + 1] - profile[i - 1] - profile[i - 2]);
      if (outer < 0 || rise[i] > rise[static_cast<std::size_t>(outer)]) {
        outer = k;
      }
    }
    if (outer < 0 || rise[static_cast<std::size_t>(outer)] <= 0.0) {
      continue;
    }
    int inner = outer;
    for (int k = std::max(kFilter, outer - kWidestJoint); k < outer; ++k) {
      if (rise[static_cast<std::size_t>(k)] < rise[static_cast<std::size_t>(inner)]) {
        inner = k;
      }
    }
    if (-rise[static_cast<std::size_t>(inner)] < kShare * rise[static_cast<std::size_t>(outer)]) {
      continue;
    }
    for (Point& point : points_) {
      if (point.side == side && point.found && std::abs(point.offset_px - (outer - 0.5 - reach)) < 2.5) {
        point.offset_px -= outer - inner;
        point.offset = point.offset_px * point.metres_per_px;
      }
    }
  }
}

std::optional<OutlineFit> OutlineFitter::fit(const GreyView& image, const Outline& outline,
                                             const OutlineFitParams& params, const Pose2& start) {
  const double camera_distance = outline.height - camera_->mounting().z;
  const double metres_per_px = camera_distance / std::max(camera_->intrinsics().fx, 1.0);
  const bool faint = params.expected_step < 8.0 * params.pixel_noise;
  // A narrow outline's opposite edge must stay out of the filter and the search.
  const double narrow_px = std::min(outline.width, outline.length) / metres_per_px;
  const int half_filter = std::clamp(static_cast<int>(narrow_px / 4.0), 1, faint ? 4 : 2);
  int lines = 1;
  if (faint) {
    const double ratio = 2.5 * params.pixel_noise / (0.6 * std::max(params.expected_step, 1.0));
    lines = std::clamp(static_cast<int>(std::ceil(2.0 * ratio * ratio / half_filter)), 3, 12);
  }
  place_points(outline, metres_per_px, std::max(6.0, lines + 1.0));
  const int widest = std::max(3, std::min(params.first_search_px, static_cast<int>(0.45 * narrow_px)));
  const std::array<Pass, 4> passes{
      {{widest, 8.0}, {std::min(widest, 6), 4.0}, {std::min(widest, 4), 2.0}, {std::min(widest, 4), 1.6}}};

  OutlineFit fit;
  Pose2 pose = start;
  double swelling = 0.0;
  double taper = 0.0;
  for (std::size_t pass = 0; pass < passes.size(); ++pass) {
    const double least_edge = std::max(params.least_edge, pass == 0 ? 0.0 : kFaintest * fit.step);
    measure(
        image, outline, params, pose, swelling, taper,
        {.search_px = passes[pass].search_px, .half_filter = half_filter, .lines = lines, .least_edge = least_edge});
    const double cutoff = passes[pass].cutoff_px;

    // The first pass tolerates a start that is off as a whole: residuals are judged against their side's median. So do
    // all for unlit fixtures: a joint of the ceiling beside one moves a whole side by its width and cannot always be
    // told from it.
    std::array<double, kSides> centre_px{};
    if (pass == 0 || !params.inside_brighter) {
      for (int side = 0; side < kSides; ++side) {
        std::array<double, 64> offsets;
        std::size_t count = 0;
        for (const Point& point : points_) {
          if (point.side == side && point.found && count < offsets.size()) {
            offsets[count++] = point.offset_px;
          }
        }
        if (count > 0) {
          std::nth_element(offsets.begin(), offsets.begin() + static_cast<std::ptrdiff_t>(count / 2),
                           offsets.begin() + static_cast<std::ptrdiff_t>(count));
          const double limit = pass == 0 ? 1e9 : kLargestSideOffset;
          centre_px[static_cast<std::size_t>(side)] = std::clamp(offsets[count / 2], -limit, limit);
        }
      }
    }

    // Priors: the swelling is about zero, and what no edge holds stays where it is.
    Matrix5d information = Matrix5d::Zero();
    Vector5d right_side = Vector5d::Zero();
    const double sigma = params.edge_sigma_px * metres_per_px;
    const double free_along = std::max(outline.length, outline.width);
    information(0, 0) = information(1, 1) = sigma * sigma / (free_along * free_along);
    information(2, 2) = sigma * sigma / (kPi * kPi);
    information(3, 3) = sigma * sigma / (params.swelling_sigma * params.swelling_sigma);
    right_side(3) = -information(3, 3) * swelling;
    information(4, 4) = sigma * sigma / (params.taper_sigma * params.taper_sigma);
    right_side(4) = -information(4, 4) * taper;

    fit.in_view.fill(0);
    fit.on_edge.fill(0);
    fit.expected.fill(0);
    fit.corner_in_view.fill(0);
    fit.side_step.fill(0.0);
    fit.corner_on_edge.fill(0);
    fit.visible_from = 0.5 * outline.length;
    fit.visible_to = -0.5 * outline.length;
    double squares = 0.0;
    double steps = 0.0;
    int used = 0;
    for (const Point& point : points_) {
      const auto side = static_cast<std::size_t>(point.side);
      ++fit.expected[side];
      if (!point.in_view) {
        continue;
      }
      ++fit.in_view[side];
      const bool long_side = point.side == kLeftSide || point.side == kRightSide;
      const bool at_corner = long_side && std::abs(point.place.x()) > kCornerStretch * outline.length;
      const std::size_t corner = point.place.x() > 0.0 ? 0 : 1;
      fit.corner_in_view[corner] += at_corner ? 1 : 0;
      if (long_side) {
        fit.visible_from = std::min(fit.visible_from, point.place.x());
        fit.visible_to = std::max(fit.visible_to, point.place.x());
      }
      if (!point.found) {
        continue;
      }
      const double weight = tukey_weight(point.offset_px - centre_px[side], cutoff);
      if (weight <= 0.0) {
        continue;
      }
      const double arm = outline.shape == FixtureShape::kRound
                             ? 0.0
                             : point.normal.y() * point.place.x() - point.normal.x() * point.place.y();
      Vector5d jacobian;
      jacobian << point.normal.x(), point.normal.y(), arm, 1.0, point.place.x();
      information += weight * jacobian * jacobian.transpose();
      right_side += weight * point.offset * jacobian;
      ++fit.on_edge[side];
      fit.corner_on_edge[corner] += at_corner ? 1 : 0;
      squares += point.offset_px * point.offset_px;
      steps += point.step;
      fit.side_step[side] += point.step;
      ++used;
    }
    if (used < kLeastPoints || is_hopeless(fit)) {
      return std::nullopt;
    }
    const Vector5d step = information.ldlt().solve(right_side);
    if (!step.allFinite() || std::abs(step(2)) > 0.5) {
      return std::nullopt;
    }
    const double c = std::cos(pose.theta);
    const double s = std::sin(pose.theta);
    pose = {pose.x + c * step(0) - s * step(1), pose.y + s * step(0) + c * step(1), wrap_angle(pose.theta + step(2))};
    swelling += step(3);
    taper += step(4);

    fit.residual_px = std::sqrt(squares / used);
    fit.step = steps / used;
    for (std::size_t side = 0; side < kSides; ++side) {
      fit.side_step[side] /= std::max(fit.on_edge[side], 1);
    }
    if (pass + 1 == passes.size()) {
      const double edge_sigma = std::max(params.edge_sigma_px, fit.residual_px) * metres_per_px;
      const Matrix5d inverse = information.inverse();
      fit.covariance = edge_sigma * edge_sigma * inverse.topLeftCorner<3, 3>();
      const double shared = params.outline_sigma_px * metres_per_px;
      const double lever = 0.3 * std::max(fit.visible_to - fit.visible_from, 0.5 * outline.width);
      fit.covariance(0, 0) += shared * shared;
      fit.covariance(1, 1) += shared * shared;
      fit.covariance(2, 2) += shared * shared / (lever * lever);
      if (!params.inside_brighter) {
        const double ends = 0.6 * std::max(std::abs(centre_px[kFarEnd]), std::abs(centre_px[kNearEnd]));
        const double sides = 0.6 * std::max(std::abs(centre_px[kLeftSide]), std::abs(centre_px[kRightSide]));
        fit.covariance(0, 0) += std::pow(ends * metres_per_px, 2) + kJointSigma * kJointSigma;
        // a joint along one side only widens the outline and shifts it by as much
        fit.covariance(1, 1) += std::pow(sides * metres_per_px, 2) + swelling * swelling;
      } else {
        // bloom is not quite the same on all sides
        const double bloom = 0.1 * swelling;
        fit.covariance(0, 0) += bloom * bloom;
        fit.covariance(1, 1) += bloom * bloom;
        fit.covariance(2, 2) += 0.25 * bloom * bloom / (lever * lever);
      }
    }
  }
  fit.robot_from_outline = pose;
  fit.swelling = swelling;
  return fit;
}

}  // namespace luminav
