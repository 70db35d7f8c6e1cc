#include "services/detector/outline/edge_search.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/sampling/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kAhead = 0.02;   // [m] to find the normal's direction in the image
constexpr int kMinSearch = 3;     // [px] outwards that must be in view
constexpr float kNearer = 0.03F;  // [1/px] by which an edge counts for less that lies farther from the prediction
constexpr double kCertain = 2.5;  // sigmas of noise that a step must have
constexpr int kNearMean = 3;      // [px] from the edge of a side's mean profile
constexpr int kLinePx = 7;        // lines of the ceiling's grid are narrower: 15 mm, blurred
constexpr std::size_t kMinThinned = 14;  // points of a side of which half will do at first
constexpr double kFaint = 0.6;           // of the least step otherwise: the mean of a side is certain
constexpr double kLikely = 1.0;          // sigmas of a single profile's step beside a certain mean
constexpr double kMinShare = 0.4;        // of the mean's step

template <typename Profile>
void add_to(Profile& sum, const Profile& profile) {
  for (std::size_t k = 0; k < profile.size(); ++k) {
    sum[k] += profile[k];
  }
}

}  // namespace

std::span<const EdgePoint> EdgeSearch::points_of(int side) const {
  const auto s = static_cast<std::size_t>(side);
  return std::span(points_).subspan(first_of_side_[s], first_of_side_[s + 1] - first_of_side_[s]);
}

std::span<EdgePoint> EdgeSearch::own_points_of(int side) {
  const auto s = static_cast<std::size_t>(side);
  return std::span(points_).subspan(first_of_side_[s], first_of_side_[s + 1] - first_of_side_[s]);
}

void EdgeSearch::add_side(int side, const Vector2d& middle, const Vector2d& along, const Vector2d& normal,
                          double usable, int count) {
  for (int i = 0; i < count; ++i) {
    const double t = usable * ((i + 0.5) / count - 0.5);
    points_.push_back({.place = middle + t * along, .normal = normal, .side = side});
  }
  first_of_side_[static_cast<std::size_t>(side) + 1] = points_.size();
}

void EdgeSearch::spread_points(const Outline& outline, double metres_per_px, double spacing_px) {
  points_.clear();
  const double spacing = metres_per_px * spacing_px;
  if (outline.shape == FixtureShape::kRound) {
    const double radius = 0.5 * outline.length;
    const int count = std::clamp(static_cast<int>(2.0 * kPi * radius / spacing), 16, 64);
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * kPi * i / count;
      const Vector2d normal(std::cos(angle), std::sin(angle));
      points_.push_back({.place = radius * normal, .normal = normal, .side = kLeftSide});
    }
    first_of_side_.fill(points_.size());
    first_of_side_[kLeftSide] = 0;
    return;
  }
  const double half_length = 0.5 * outline.length;
  const double half_width = 0.5 * outline.width;
  const double of_side = outline.length - 2.0 * std::min(0.12 * outline.length, 5.0 * metres_per_px);
  const double of_end = outline.width - 2.0 * std::min(0.20 * outline.width, 8.0 * metres_per_px);
  const int on_side = std::clamp(static_cast<int>(of_side / spacing), 5, 48);
  const int on_end = std::clamp(static_cast<int>(of_end / spacing), 7, 48);
  const Vector2d x = Vector2d::UnitX();
  const Vector2d y = Vector2d::UnitY();
  add_side(kLeftSide, half_width * y, x, y, of_side, on_side);
  add_side(kRightSide, -half_width * y, x, -y, of_side, on_side);
  add_side(kFarEnd, half_length * x, y, x, of_end, on_end);
  add_side(kNearEnd, -half_length * x, y, -x, of_end, on_end);
}

/// Of each point, and of one ahead of it along its normal.
void EdgeSearch::project(std::size_t first, std::size_t last) {
  const PointTransform pose(placement_.pose);
  for (std::size_t i = first; i < last; ++i) {
    const EdgePoint& point = points_[i];
    const bool is_end = point.side == kFarEnd || point.side == kNearEnd;
    const Vector2d place = point.place + (is_end ? placement_.end_outset : placement_.side_outset) * point.normal;
    ceiling_points_[2 * i] = pose * place;
    ceiling_points_[2 * i + 1] = pose * (place + kAhead * point.normal);
  }
  const std::size_t count = 2 * (last - first);
  camera_->pixels_of_ceiling_points(std::span(ceiling_points_).subspan(2 * first, count), height_,
                                    std::span(pixels_).subspan(2 * first, count));
}

/// Near the border the search ends early: what lies beyond is taken to be like the last that is seen.
void EdgeSearch::sample(const GreyView& image, std::size_t index, const EdgeSearchParams& params) {
  EdgePoint& point = points_[index];
  point.found = false;
  point.in_view = false;
  const Vector2d& pixel = pixels_[2 * index];
  const Vector2d ahead = pixels_[2 * index + 1] - pixel;
  const double px_per_step = ahead.norm();
  if (!(px_per_step >= 1e-6)) {  // or not a number
    return;
  }
  const Vector2d normal = ahead / px_per_step;
  const double half_lines = 0.5 * (params.lines - 1);
  const Vector2d along(-normal.y(), normal.x());
  const auto is_in_view = [&](int distance) {
    const Vector2d middle = pixel + distance * normal;
    return is_sampled(image, middle + half_lines * along) && is_sampled(image, middle - half_lines * along);
  };
  if (!is_in_view(-reach_)) {
    return;
  }
  int seen = reach_;
  const int least = std::min(reach_, params.half_filter + kMinSearch);
  while (seen >= least && !is_in_view(seen)) {
    --seen;
  }
  if (seen < least) {
    return;
  }
  point.in_view = true;
  point.metres_per_px = kAhead / px_per_step;
  Profile& profile = profiles_[index];
  profile.fill(0.0F);
  const auto dx = static_cast<float>(normal.x());
  const auto dy = static_cast<float>(normal.y());
  const float share = 1.0F / static_cast<float>(params.lines);
  for (int line = 0; line < params.lines; ++line) {
    const Vector2d start = pixel + (line - half_lines) * along - reach_ * normal;
    const auto x = static_cast<float>(start.x());
    const auto y = static_cast<float>(start.y());
    for (int k = 0; k <= reach_ + seen; ++k) {
      const auto t = static_cast<float>(k);
      profile[static_cast<std::size_t>(k)] += share * bilinear(image, x + t * dx, y + t * dy);
    }
  }
  std::fill(profile.begin() + reach_ + seen + 1, profile.begin() + 2 * reach_ + 1,
            profile[static_cast<std::size_t>(reach_ + seen)]);
}

std::optional<EdgeSearch::Step> EdgeSearch::largest_step(const Profile& profile, const EdgeSearchParams& params,
                                                         const Window& window) const {
  const int length = 2 * reach_ + 1;
  std::array<float, kMaxLength + 1> sums;
  std::array<float, kMaxLength + 1> response;
  sums[0] = 0.0F;
  for (std::size_t k = 0; k < static_cast<std::size_t>(length); ++k) {
    sums[k + 1] = sums[k] + profile[k];
  }
  // difference of the means of half_filter pixels inside and outside of the boundary before pixel k
  const auto h = static_cast<std::size_t>(params.half_filter);
  const float scale = (params.inside_brighter ? 1.0F : -1.0F) / static_cast<float>(params.half_filter);
  const int from = std::max(window.first, params.half_filter);
  const int to = std::min(window.last, length - params.half_filter);
  int best = -1;
  float best_score = 0.0F;
  for (int k = from; k <= to; ++k) {
    const auto i = static_cast<std::size_t>(k);
    response[i] = scale * (2.0F * sums[i] - sums[i - h] - sums[i + h]);
    // Of two edges the nearer to the prediction.
    const float away = std::abs(static_cast<float>(k - reach_) - 0.5F);
    const float score = response[i] * (1.0F - kNearer * away);
    if (score > best_score) {
      best_score = score;
      best = k;
    }
  }
  if (best <= from || best >= to) {
    return std::nullopt;
  }
  const auto at = static_cast<std::size_t>(best);
  const double curvature = response[at - 1] - 2.0F * response[at] + response[at + 1];
  const double vertex =
      curvature < -1e-6 ? std::clamp(0.5 * (response[at - 1] - response[at + 1]) / curvature, -1.0, 1.0) : 0.0;
  return Step{best - 0.5 - reach_ + vertex, response[at]};
}

/// Fills dark lines narrower than kLinePx pixels up to the lower of their rims (closing): the grid beside an unlit
/// fixture has edges higher than the fixture's own. Windows of 7 are put together from those of 4, and these of 2.
void EdgeSearch::fill_lines(Profile& profile) const {
  static_assert(kLinePx == 7);
  constexpr std::size_t kMargin = kLinePx / 2;
  const auto length = static_cast<std::size_t>(2 * reach_ + 1);
  std::array<float, kMaxLength + 2 * kMargin> padded;
  const auto close = [&](float beyond, auto extreme) {
    const std::size_t padded_length = length + 2 * kMargin;
    std::fill_n(padded.begin(), kMargin, beyond);
    std::copy_n(profile.begin(), length, padded.begin() + kMargin);
    std::fill_n(padded.begin() + kMargin + length, kMargin, beyond);
    for (const std::size_t ahead : {std::size_t{1}, std::size_t{2}}) {
      for (std::size_t k = 0; k + ahead < padded_length; ++k) {
        padded[k] = extreme(padded[k], padded[k + ahead]);
      }
    }
    for (std::size_t k = 0; k < length; ++k) {
      profile[k] = extreme(padded[k], padded[k + kMargin]);
    }
  };
  close(0.0F, [](float a, float b) { return std::max(a, b); });
  close(255.0F, [](float a, float b) { return std::min(a, b); });
}

/// Each profile's own edge; where single profiles are too noisy, the mean of all of a side still shows where it is, and
/// a fainter step there will do.
void EdgeSearch::search_side(int side, const EdgeSearchParams& params) {
  const double noise = params.pixel_noise * std::sqrt(2.0 / static_cast<double>(params.half_filter * params.lines));
  const Window everywhere{0, 2 * reach_ + 1};
  Profile mean{};
  int in_view = 0;
  for (EdgePoint& point : own_points_of(side)) {
    if (!point.in_view) {
      continue;
    }
    ++in_view;
    Profile& profile = profile_of(point);
    if (!params.inside_brighter) {
      fill_lines(profile);
    }
    add_to(mean, profile);
    const auto step = largest_step(profile, params, everywhere);
    if (step && step->height > std::max(params.min_edge, kCertain * noise)) {
      point.found = true;
      point.offset_px = step->offset_px;
      point.step = step->height;
    }
  }
  if (in_view < 5 || first_of_side_[kRightSide] == points_.size()) {
    return;  // any texture has a mean step along a small circle
  }
  for (std::size_t k = 0; k < kMaxLength; ++k) {
    mean[k] /= static_cast<float>(in_view);
  }
  const auto common = largest_step(mean, params, everywhere);
  if (!common || common->height < std::max(kFaint * params.min_edge, kCertain * noise / std::sqrt(in_view))) {
    return;
  }
  const int middle = reach_ + static_cast<int>(std::lround(common->offset_px + 0.5));
  for (EdgePoint& point : own_points_of(side)) {
    if (point.in_view && !point.found) {
      const auto step = largest_step(profile_of(point), params, {middle - kNearMean, middle + kNearMean});
      if (step && step->height > std::max(kLikely * noise, kMinShare * common->height)) {
        point.found = true;
        point.offset_px = step->offset_px;
        point.step = step->height;
      }
    }
  }
}

void EdgeSearch::start(const OutlinePlacement& placement, double height, const EdgeSearchParams& params) {
  reach_ = std::min(params.search_px + params.half_filter, kMaxLength / 2 - 1);
  placement_ = placement;
  height_ = height;
  profiles_.resize(std::max(profiles_.size(), points_.size()));
  ceiling_points_.resize(2 * points_.size());
  pixels_.resize(2 * points_.size());
}

void EdgeSearch::leave_out(int side) {
  for (EdgePoint& point : own_points_of(side)) {
    point.in_view = point.found = false;
  }
}

void EdgeSearch::measure(const GreyView& image, const EdgeSearchParams& params, int side) {
  const auto s = static_cast<std::size_t>(side);
  const std::size_t first = first_of_side_[s];
  const std::size_t last = first_of_side_[s + 1];
  project(first, last);
  const bool thinned = params.is_first && last - first >= kMinThinned;
  for (std::size_t i = first; i < last; ++i) {
    if (thinned && (i - first) % 2 == 1) {
      points_[i].in_view = points_[i].found = false;
    } else {
      sample(image, i, params);
    }
  }
  search_side(side, params);
}

}  // namespace luminav
