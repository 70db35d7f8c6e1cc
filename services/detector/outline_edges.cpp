#include "services/detector/outline_edges.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kLeastOfLitEnd = 7;      // points
constexpr double kWidestBloom = 14.0;  // [px] 0.065 m, 2.3 m above the camera
constexpr int kLeastSearch = 3;        // [px] outwards
constexpr double kCertain = 2.5;       // sigmas of noise that a step must have

}  // namespace

void OutlineEdges::place(const Outline& outline, double metres_per_px, double spacing_px, bool lit) {
  points_.clear();
  if (outline.shape == FixtureShape::kRound) {
    const double radius = 0.5 * outline.length;
    const int count = std::clamp(static_cast<int>(2.0 * kPi * radius / (metres_per_px * spacing_px)), 16, 64);
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * kPi * i / count;
      const Vector2d normal(std::cos(angle), std::sin(angle));
      points_.push_back({.place = radius * normal, .normal = normal, .side = kLeftSide});
    }
    first_of_side_.fill(points_.size());
    first_of_side_[kLeftSide] = 0;
    return;
  }
  const auto add_side = [&](int side, const Vector2d& middle, const Vector2d& along, const Vector2d& normal,
                            double extent) {
    // corners are rounded by blur and bloom, those of a diffuser by themselves: keep away from them
    const bool round = lit && (side == kFarEnd || side == kNearEnd);
    const double usable = extent - 2.0 * std::min((round ? 0.20 : 0.12) * extent, (round ? 8.0 : 5.0) * metres_per_px);
    const int count =
        std::clamp(static_cast<int>(usable / (metres_per_px * spacing_px)), round ? kLeastOfLitEnd : 5, 48);
    for (int i = 0; i < count; ++i) {
      const double t = usable * ((i + 0.5) / count - 0.5);
      points_.push_back({.place = middle + t * along, .normal = normal, .side = side});
    }
    first_of_side_[static_cast<std::size_t>(side) + 1] = points_.size();
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

/// Projects the points and keeps those whose surroundings are in view.
void OutlineEdges::look_at(const GreyView& image, const Outline& outline, const OutlinePlacement& placement,
                           const EdgeSearch& search, int reach) {
  constexpr double kAhead = 0.02;  // [m] to find the normal's direction in the image
  const PointTransform pose(placement.pose);
  const std::size_t first = first_of(search.first_side);
  const std::size_t count = first_of(search.last_side + 1) - first;
  ceiling_points_.resize(2 * count);
  pixels_.resize(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const OutlinePoint& point = points_[first + i];
    const Vector2d on_outline = point.place + (placement.swelling + placement.taper * point.place.x()) * point.normal;
    ceiling_points_[2 * i] = pose * on_outline;
    ceiling_points_[2 * i + 1] = pose * (on_outline + kAhead * point.normal);
  }
  camera_->pixels_of_ceiling_points(ceiling_points_, outline.height, pixels_);

  const int least = std::min(reach, search.half_filter + kLeastSearch);
  const double half_lines = 0.5 * (search.lines - 1);
  const double margin = reach + half_lines + 2.0;  // to the border, where all is in view
  viewed_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    OutlinePoint& point = points_[first + i];
    point.found = false;
    point.in_view = false;
    if (i % search.every != search.every / 2) {
      continue;
    }
    const Vector2d& pixel = pixels_[2 * i];
    const Vector2d& ahead = pixels_[2 * i + 1];
    const double px_per_step = (ahead - pixel).norm();
    if (!(px_per_step >= 1e-6)) {  // or not a number
      continue;
    }
    const Vector2d normal_px = (ahead - pixel) / px_per_step;
    int seen = reach;
    if (!camera_->is_in_image(pixel, margin)) {
      const Vector2d aside = half_lines * Vector2d(-normal_px.y(), normal_px.x());
      // Near the border the search ends early: what lies beyond is taken to be like the last that is seen.
      const auto is_in_view = [&](double distance) {
        const Vector2d middle = pixel + distance * normal_px;
        return is_sampled(image, middle + aside) && is_sampled(image, middle - aside);
      };
      if (!is_in_view(-reach)) {
        continue;
      }
      while (seen >= least && !is_in_view(seen)) {
        --seen;
      }
      if (seen < least) {
        continue;
      }
    }
    point.in_view = true;
    point.at_border = !camera_->is_in_image(pixel + kWidestBloom * normal_px);
    point.metres_per_px = kAhead / px_per_step;
    viewed_.push_back({first + i, pixel, normal_px, reach + seen});
  }
}

/// Profiles of up to eight of the viewed points, from `first` on.
void OutlineEdges::sample(const GreyView& image, const EdgeSearch& search, int reach, std::size_t first) {
  lanes_.clear(2 * reach + 1);
  const std::size_t count = std::min<std::size_t>(viewed_.size() - first, ProfileLanes::kLanes);
  ProfileLanes::Lines lines;
  for (int line = 0; line < search.lines; ++line) {
    const double aside = line - 0.5 * (search.lines - 1);
    for (std::size_t lane = 0; lane < ProfileLanes::kLanes; ++lane) {
      const ViewedPoint& point = viewed_[first + std::min(lane, count - 1)];
      const Vector2d along_px(-point.normal_px.y(), point.normal_px.x());
      const Vector2d start = point.pixel + aside * along_px - reach * point.normal_px;
      lines.x[lane] = static_cast<float>(start.x());
      lines.y[lane] = static_cast<float>(start.y());
      lines.dx[lane] = static_cast<float>(point.normal_px.x());
      lines.dy[lane] = static_cast<float>(point.normal_px.y());
      lines.last[lane] = point.last;
    }
    lanes_.add(image, lines);
  }
}

/// Where the parabola through the steps at and beside the place `at` has its vertex.
OutlineEdges::Step OutlineEdges::vertex_at(int at, int reach, double before, double height, double behind) {
  const double curvature = before - 2.0 * height + behind;
  const double vertex = curvature < -1e-6 ? std::clamp(0.5 * (before - behind) / curvature, -1.0, 1.0) : 0.0;
  return {at - 0.5 - reach + vertex, height};
}

std::optional<OutlineEdges::Step> OutlineEdges::largest_step(const Profile& profile, int length, int half_filter,
                                                             float weight, int first, int last) {
  std::array<float, kLongest + 1> sums;
  std::array<float, kLongest + 1> response;
  sums[0] = 0.0F;
  for (int k = 0; k < length; ++k) {
    sums[static_cast<std::size_t>(k) + 1] = sums[static_cast<std::size_t>(k)] + profile[static_cast<std::size_t>(k)];
  }
  // difference of the means of half_filter pixels inside and outside of the boundary before pixel k
  const auto h = static_cast<std::size_t>(half_filter);
  const float scale = weight / static_cast<float>(half_filter);
  const int reach = length / 2;
  int best = -1;
  float best_score = 0.0F;
  const int from = std::max(first, half_filter);
  const int to = std::min(last, length - half_filter);
  for (int k = from; k <= to; ++k) {
    const auto i = static_cast<std::size_t>(k);
    response[i] = scale * (2.0F * sums[i] - sums[i - h] - sums[i + h]);
    // of two edges of the same height, the nearer to the prediction
    const float score = response[i] * (1.0F - 0.02F * std::abs(static_cast<float>(k - reach) - 0.5F));
    if (score > best_score) {
      best_score = score;
      best = k;
    }
  }
  if (best <= from || best >= to) {
    return std::nullopt;
  }
  const auto at = static_cast<std::size_t>(best);
  return vertex_at(best, reach, response[at - 1], response[at], response[at + 1]);
}

void OutlineEdges::measure(const GreyView& image, const Outline& outline, const OutlineFitParams& params,
                           const OutlinePlacement& placement, const EdgeSearch& search) {
  const double noise = params.pixel_noise * std::sqrt(2.0 / static_cast<double>(search.half_filter * search.lines));
  const double threshold = std::max(search.least_edge, kCertain * noise);
  const float weight = (params.inside_brighter ? 1.0F : -1.0F) / static_cast<float>(search.lines);
  const int reach = std::min(search.search_px + search.half_filter, kLongest / 2 - 1);
  const int length = 2 * reach + 1;
  const bool unlit = !params.inside_brighter;
  if (unlit) {
    profiles_.resize(std::max(profiles_.size(), points_.size()));
    for (int side = search.first_side; side <= search.last_side; ++side) {
      side_profiles_[static_cast<std::size_t>(side)].fill(0.0F);
    }
  }
  look_at(image, outline, placement, search, reach);
  for (std::size_t first = 0; first < viewed_.size(); first += ProfileLanes::kLanes) {
    sample(image, search, reach, first);
    const ProfileLanes::Steps steps = lanes_.largest_steps(search.half_filter, weight);
    const std::size_t count = std::min<std::size_t>(viewed_.size() - first, ProfileLanes::kLanes);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::size_t index = viewed_[first + lane].index;
      OutlinePoint& point = points_[index];
      if (unlit) {
        Profile& profile = profiles_[index];
        lanes_.copy_lane(lane, profile.data());
        Profile& sum = side_profiles_[static_cast<std::size_t>(point.side)];
        for (int k = 0; k < length; ++k) {
          sum[static_cast<std::size_t>(k)] += profile[static_cast<std::size_t>(k)];
        }
      }
      if (steps.at[lane] >= 0 && steps.height[lane] >= threshold) {
        const Step step = vertex_at(steps.at[lane], reach, steps.before[lane], steps.height[lane], steps.behind[lane]);
        point.take(step.offset_px, step.height);
      }
    }
  }
  if (unlit) {
    if (outline.shape != FixtureShape::kRound) {
      look_again(params, search, reach);  // any texture has a mean step along a small circle
    }
    take_joints_off(params, search, reach);
  }
}

std::ptrdiff_t OutlineEdges::count_in_view(int side) const {
  const std::span<const OutlinePoint> points = points_of(side);
  return std::count_if(points.begin(), points.end(), [](const OutlinePoint& point) { return point.in_view; });
}

bool OutlineEdges::runs_along_border(int side) const {
  const std::span<const OutlinePoint> points = points_of(side);
  const auto at_border = std::count_if(points.begin(), points.end(),
                                       [](const OutlinePoint& point) { return point.in_view && point.at_border; });
  const auto farther = count_in_view(side) - at_border;
  return farther < std::min<std::ptrdiff_t>(kLeastToRefute, std::max<std::ptrdiff_t>(at_border, 1));
}

void OutlineEdges::leave_out(int side) {
  for (OutlinePoint& point : own_points_of(side)) {
    point.in_view = false;
    point.found = false;
  }
}

void OutlineEdges::follow(const OutlineMove& move) {
  for (OutlinePoint& point : points_) {
    if (point.found) {
      const double arm = point.normal.y() * point.place.x() - point.normal.x() * point.place.y();
      point.offset -= point.normal.dot(move.shift) + arm * move.turn + move.swelling + point.place.x() * move.taper;
      point.offset_px = point.offset / point.metres_per_px;
    }
  }
}

/// Where single profiles are too noisy, the mean of all of a side still shows its edge; then a fainter step there will
/// do.
void OutlineEdges::look_again(const OutlineFitParams& params, const EdgeSearch& search, int reach) {
  constexpr int kNear = 3;             // [px] from the side's edge
  constexpr double kFaint = 0.6;       // of the least step otherwise: the mean is certain
  constexpr double kLikely = 1.0;      // sigmas of a single profile's step
  constexpr double kLeastShare = 0.4;  // of the side's step
  const int length = 2 * reach + 1;
  const double noise = params.pixel_noise * std::sqrt(2.0 / static_cast<double>(search.half_filter * search.lines));
  const float weight = -1.0F / static_cast<float>(search.lines);
  for (int side = search.first_side; side <= search.last_side; ++side) {
    const std::ptrdiff_t in_view = count_in_view(side);
    if (in_view < 5) {
      continue;
    }
    const auto mean = largest_step(side_profiles_[static_cast<std::size_t>(side)], length, search.half_filter,
                                   weight / static_cast<float>(in_view), 0, length);
    const double least = std::max(
        {params.least_edge, kFaint * search.least_edge, kCertain * noise / std::sqrt(static_cast<double>(in_view))});
    if (!mean || mean->height < least) {
      continue;
    }
    const int middle = reach + static_cast<int>(std::lround(mean->offset_px + 0.5));
    for (std::size_t i = first_of(side); i < first_of(side + 1); ++i) {
      OutlinePoint& point = points_[i];
      if (!point.in_view || point.found) {
        continue;
      }
      const auto step = largest_step(profiles_[i], length, search.half_filter, weight, middle - kNear, middle + kNear);
      if (step && step->height > std::max(kLikely * noise, kLeastShare * mean->height)) {
        point.take(step->offset_px, step->height);
      }
    }
  }
}

/// An unlit fixture often ends at a joint of the ceiling, which is darker still: then the strongest edge is the joint's
/// far one, a joint's width outside of the fixture. The mean profile of a side shows it: before the step up there is
/// one further down, from the fixture to the joint.
void OutlineEdges::take_joints_off(const OutlineFitParams& params, const EdgeSearch& search, int reach) {
  constexpr int kFilter = 2;       // [px] narrower than a joint
  constexpr int kWidestJoint = 6;  // [px]
  constexpr double kShare = 0.35;  // of the step up
  constexpr double kSigmas = 4.0;  // of noise that the step down must have
  const int length = 2 * reach + 1;
  for (int side = search.first_side; side <= search.last_side; ++side) {
    const auto& profile = side_profiles_[static_cast<std::size_t>(side)];
    std::array<double, kLongest> rise{};
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
    const std::ptrdiff_t in_view = count_in_view(side);
    const double noise =
        params.pixel_noise * std::sqrt(static_cast<double>(search.lines) * static_cast<double>(in_view));
    if (-rise[static_cast<std::size_t>(inner)] <
        std::max(kShare * rise[static_cast<std::size_t>(outer)], kSigmas * noise)) {
      continue;
    }
    for (OutlinePoint& point : own_points_of(side)) {
      if (point.found && std::abs(point.offset_px - (outer - 0.5 - reach)) < 2.5) {
        point.offset_px -= outer - inner;
        point.offset = point.offset_px * point.metres_per_px;
      }
    }
  }
}

}  // namespace luminav
