#include "services/detector/outline/outline_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

namespace luminav {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr int kMinPoints = 6;
constexpr int kMinToRefute = 5;       // points of a long side in view
constexpr double kMinShare = 0.45;    // of them that must lie on edges
constexpr double kOfHeading = 0.4;    // of the error that a side's points share, by which they turn it
constexpr double kGridLine = 0.0045;  // [m] 1 sigma of an unlit fixture's end: it may be a grid line's, 12 mm wide

struct Pass {
  int search_px;
  double cutoff_px;
};

double tukey_weight(double residual, double cutoff) {
  const double ratio = residual / cutoff;
  const double rest = 1.0 - ratio * ratio;
  return rest <= 0.0 ? 0.0 : rest * rest;
}

/// Geometric mean over both axes of the image.
double metres_per_pixel(const CeilingCamera& camera, const Vector2d& place, double height) {
  constexpr double kStep = 0.02;  // [m]
  const auto here = camera.pixel_of_ceiling_point(place, height);
  const auto ahead = camera.pixel_of_ceiling_point(place + kStep * Vector2d::UnitX(), height);
  const auto aside = camera.pixel_of_ceiling_point(place + kStep * Vector2d::UnitY(), height);
  if (here && ahead && aside) {
    const Vector2d a = *ahead - *here;
    const Vector2d b = *aside - *here;
    const double area = std::abs(a.x() * b.y() - a.y() * b.x());
    if (area > 1e-6) {
      return kStep / std::sqrt(area);
    }
  }
  return (height - camera.mounting().z) / std::max(camera.intrinsics().fx, 1.0);
}

/// Of the edges found; 0 where there is none.
double median_offset(std::span<const EdgePoint> points) {
  std::array<double, 64> offsets;
  std::size_t count = 0;
  for (const EdgePoint& point : points) {
    if (point.found && count < offsets.size()) {
      offsets[count++] = point.offset_px;
    }
  }
  if (count == 0) {
    return 0.0;
  }
  const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(offsets.begin(), middle, offsets.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

OutlinePlacement moved(const OutlinePlacement& placement, const Eigen::Matrix<double, 5, 1>& step) {
  return {placement.pose * Pose2{step(0), step(1), step(2)}, placement.side_outset + step(3),
          placement.end_outset + step(4)};
}

}  // namespace

double OutlineFit::step() const {
  double sum = 0.0;
  int count = 0;
  for (const SideEdges& side : sides) {
    sum += side.step * side.on_edge;
    count += side.on_edge;
  }
  return sum / std::max(count, 1);
}

bool OutlineFit::end_visible(int side) const {
  const SideEdges& end = sides[static_cast<std::size_t>(side)];
  return end.in_view >= 2 && 4 * end.in_view >= end.expected;  // the border may hide a corner
}

void OutlineFit::leave_out_end_below(double share_of_end) {
  const Side worse = share(kFarEnd) < share(kNearEnd) ? kFarEnd : kNearEnd;
  if (ends_visible() == 2 && share(worse) < share_of_end) {
    sides[worse].in_view = sides[worse].on_edge = 0;
  }
}

std::optional<Side> OutlineFit::only_side() const {
  const bool left = sides[kLeftSide].in_view >= 3;
  const bool right = sides[kRightSide].in_view >= 3;
  if (left == right || sides[kRightSide].expected == 0) {
    return std::nullopt;
  }
  return left ? kLeftSide : kRightSide;
}

double OutlineFit::quality() const {
  int all = 0;
  int good = 0;
  for (const SideEdges& side : sides) {
    all += side.in_view;
    good += side.on_edge;
  }
  return all == 0 ? 0.0 : static_cast<double>(good) / all;
}

/// Most guesses are wrong, and one long side says so: the others need not be looked at then.
bool OutlineFitter::measure(const GreyView& image, const EdgeSearchParams& search, std::optional<Side> unseen,
                            double cutoff_px) {
  for (int side = 0; side < kSides; ++side) {
    if (side == unseen) {
      edges_.leave_out(side);
    } else {
      edges_.measure(image, search, side);
    }
    const double centre = median_offset(edges_.points_of(side));
    centre_px_[static_cast<std::size_t>(side)] = centre;
    int in_view = 0;
    int on_edge = 0;
    for (const EdgePoint& point : edges_.points_of(side)) {
      in_view += point.in_view ? 1 : 0;
      on_edge += point.found && std::abs(point.offset_px - centre) < cutoff_px ? 1 : 0;
    }
    if (side <= kRightSide && in_view >= kMinToRefute && on_edge < kMinShare * in_view) {
      return false;
    }
  }
  return true;
}

/// The sides lie about where the nominal size and the light that widens all alike have them, and what no edge holds
/// stays where it is.
OutlineFitter::Equations OutlineFitter::prior(const Outline& outline, const OutlineFitParams& params,
                                              const OutlinePlacement& placement) const {
  const double sigma = params.edge_sigma_px * metres_per_px_;
  const double free_along = std::max(outline.length, outline.width);
  Equations equations;
  equations.information.diagonal().head<3>() << std::pow(sigma / free_along, 2), std::pow(sigma / free_along, 2),
      std::pow(sigma / kPi, 2);
  const double of_side = std::pow(sigma / params.side_sigma, 2);
  const double of_difference = std::pow(sigma / params.end_sigma, 2);
  equations.information.bottomRightCorner<2, 2>() << of_side + of_difference, -of_difference, -of_difference,
      of_difference;
  equations.right_side.tail<2>() =
      -equations.information.bottomRightCorner<2, 2>() *
      Vector2d(placement.side_outset - params.side_mean, placement.end_outset - params.side_mean);
  return equations;
}

/// Edges are weighted by how far they lie from their side's median: a side may be off as a whole.
void OutlineFitter::add_edges(double cutoff_px, Equations& equations) const {
  for (const EdgePoint& point : edges_.points()) {
    const double weight =
        point.found ? tukey_weight(point.offset_px - centre_px_[static_cast<std::size_t>(point.side)], cutoff_px) : 0.0;
    if (weight <= 0.0) {
      continue;
    }
    const bool is_end = point.side == kFarEnd || point.side == kNearEnd;
    Vector5d jacobian;
    jacobian << point.normal.x(), point.normal.y(),
        point.normal.y() * point.place.x() - point.normal.x() * point.place.y(), is_end ? 0.0 : 1.0, is_end ? 1.0 : 0.0;
    equations.information += weight * jacobian * jacobian.transpose();
    equations.right_side += weight * point.offset_px * point.metres_per_px * jacobian;
    ++equations.used;
  }
}

void OutlineFitter::describe_edges(const Outline& outline, double cutoff_px, OutlineFit& fit) const {
  fit.visible_from = 0.5 * outline.length;
  fit.visible_to = -0.5 * outline.length;
  double squares = 0.0;
  int used = 0;
  for (const EdgePoint& point : edges_.points()) {
    SideEdges& side = fit.sides[static_cast<std::size_t>(point.side)];
    ++side.expected;
    if (!point.in_view) {
      continue;
    }
    ++side.in_view;
    const bool on_edge =
        point.found && std::abs(point.offset_px - centre_px_[static_cast<std::size_t>(point.side)]) < cutoff_px;
    if (point.side == kLeftSide || point.side == kRightSide) {
      fit.visible_from = std::min(fit.visible_from, point.place.x());
      fit.visible_to = std::max(fit.visible_to, point.place.x());
    }
    if (on_edge) {
      ++side.on_edge;
      side.step += point.step;
      squares += point.offset_px * point.offset_px;
      ++used;
    }
  }
  for (SideEdges& side : fit.sides) {
    side.step /= std::max(side.on_edge, 1);
  }
  fit.residual_px = std::sqrt(squares / std::max(used, 1));
}

/// Edges that scatter say less; what is known beforehand says as much as ever. Lens, blur and light move all points of
/// a side alike, by `outline_sigma_px`; what the outsets could not explain, by a part of it.
Matrix3d OutlineFitter::covariance_of(const Outline& outline, const OutlineFitParams& params, const OutlineFit& fit,
                                      const Equations& prior, const Equations& equations) const {
  const double sigma = params.edge_sigma_px * metres_per_px_;
  const double scatter = std::max(params.edge_sigma_px, fit.residual_px) * metres_per_px_;
  const Matrix5d inverse = equations.information.llt().solve(Matrix5d::Identity());
  const Matrix5d scattered =
      scatter * scatter * (equations.information - prior.information) + sigma * sigma * prior.information;
  Matrix3d covariance = (inverse * scattered * inverse).topLeftCorner<3, 3>();
  const double shared = params.outline_sigma_px * metres_per_px_;
  const double lever = 0.3 * std::max(fit.visible_to - fit.visible_from, 0.5 * outline.width);
  covariance.diagonal() += Eigen::Vector3d(shared * shared, shared * shared, std::pow(kOfHeading * shared / lever, 2));
  if (!params.inside_brighter) {
    covariance(0, 0) += kGridLine * kGridLine;
    covariance(1, 1) += std::pow(fit.placement.side_outset, 2);  // a line along one side widens and shifts it as much
  }
  return covariance;
}

std::optional<OutlineFit> OutlineFitter::fit(const GreyView& image, const Outline& outline,
                                             const OutlineFitParams& params, const OutlinePlacement& start) {
  metres_per_px_ = metres_per_pixel(*camera_, start.pose.position(), outline.height);
  const bool faint = params.expected_step < 8.0 * params.pixel_noise;
  // A narrow outline's opposite edge must stay out of the filter and the search; where it drowns, there is none.
  const double narrow_px = (params.unseen ? outline.length : std::min(outline.width, outline.length)) / metres_per_px_;
  EdgeSearchParams search{
      .inside_brighter = params.inside_brighter,
      .half_filter = std::clamp(static_cast<int>(narrow_px / 4.0), 1, faint || params.inside_brighter ? 4 : 2),
      .min_edge = params.min_edge,
      .pixel_noise = params.pixel_noise};
  if (faint) {
    const double ratio = 2.5 * params.pixel_noise / (0.6 * std::max(params.expected_step, 1.0));
    search.lines = std::clamp(static_cast<int>(std::ceil(2.0 * ratio * ratio / search.half_filter)), 3, 12);
  }
  edges_.spread_points(outline, metres_per_px_, std::max(6.0, search.lines + 1.0));

  const int widest = std::max(3, std::min(11, static_cast<int>(0.45 * narrow_px)));
  // Beside a dark fixture a line of the grid may hide its edge: it is found beyond the line.
  const int last = std::min(widest, params.inside_brighter ? 4 : 7);
  const std::array<Pass, 3> passes{{{widest, 8.0}, {std::min(widest, 7), 4.0}, {last, 2.0}}};
  OutlineFit fit{.placement = start, .metres_per_px = metres_per_px_};
  for (const Pass& pass : passes) {
    search.search_px = pass.search_px;
    search.is_first = &pass == &passes.front();
    edges_.start(fit.placement, outline.height, search);
    if (!measure(image, search, params.unseen, pass.cutoff_px)) {
      return std::nullopt;
    }
    const Equations before = prior(outline, params, fit.placement);
    Equations equations = before;
    add_edges(pass.cutoff_px, equations);
    const Vector5d step = equations.information.llt().solve(equations.right_side);
    if (equations.used < kMinPoints || !step.allFinite() || std::abs(step(2)) > 0.5) {
      return std::nullopt;
    }
    fit.placement = moved(fit.placement, step);
    if (&pass == &passes.back()) {
      describe_edges(outline, pass.cutoff_px, fit);
      fit.covariance = covariance_of(outline, params, fit, before, equations);
    }
  }
  return fit;
}

}  // namespace luminav
