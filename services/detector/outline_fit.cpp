#include "services/detector/outline_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "services/detector/side_sums.hpp"

namespace luminav {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Eigen::Vector2d;

constexpr int kLeastPoints = 6;
constexpr double kCornerStretch = 0.36;     // of the length, from the middle: beyond it a long side is next to its end
constexpr double kLargestSideOffset = 3.2;  // [px] a joint of 12 mm, 2.5 m away
constexpr double kLargestLensError = 2.0;   // [px] by which a side of a lit fixture may lie elsewhere as a whole
constexpr double kJointSigma = 0.0045;      // [m] of an unlit fixture's end: it may be a joint's edge, 12 mm wide
constexpr double kLeastShare = 0.45;        // of the points of a long side that must lie on edges
constexpr double kLeastOfEnd = 0.75;        // of an end's beside the border
constexpr double kFaintest = 0.4;           // of the mean step: fainter ones belong to something else
// Of a lit outline (rendered frames: as accurate as with all passes looking anew at all points):
constexpr std::size_t kEveryAtFirst = 2;  // so many points of a straight side is one looked at in the first pass
constexpr std::size_t kManyPoints = 16;   // of a long side: with fewer, one that is half hidden would be lost
constexpr double kNearStart = 2.0;        // [px] moved by the first pass: the search need not be so wide again
constexpr double kSettled = 0.3;          // [px] moved: its edges would be found at the same places again

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
double median_offset(std::span<const OutlinePoint> points) {
  std::array<double, 64> offsets;
  std::size_t count = 0;
  for (const OutlinePoint& point : points) {
    if (point.found && count < offsets.size()) {
      offsets[count++] = point.offset_px;
    }
  }
  if (count == 0) {
    return 0.0;
  }
  std::nth_element(offsets.begin(), offsets.begin() + static_cast<std::ptrdiff_t>(count / 2),
                   offsets.begin() + static_cast<std::ptrdiff_t>(count));
  return offsets[count / 2];
}

/// True when of a side in view, of which `least_in_view` points are seen, less than `least_share` lies on edges.
bool has_few_edges(std::span<const OutlinePoint> points, double centre_px, double cutoff_px, double least_share,
                   int least_in_view = kLeastToRefute) {
  int in_view = 0;
  int on_edge = 0;
  for (const OutlinePoint& point : points) {
    in_view += point.in_view ? 1 : 0;
    on_edge += point.found && tukey_weight(point.offset_px - centre_px, cutoff_px) > 0.0 ? 1 : 0;
  }
  return in_view >= least_in_view && static_cast<double>(on_edge) / in_view < least_share;
}

/// [m] by which the edges of an outline moved at most, at its corners.
double largest_move(const Outline& outline, const OutlineMove& move) {
  return move.shift.norm() + std::abs(move.turn) * 0.5 * std::hypot(outline.length, outline.width) +
         std::abs(move.swelling) + std::abs(move.taper) * 0.5 * outline.length;
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
  // half of an end, or less of it where the border cuts off a long side
  const bool one_side = in_view[kLeftSide] == 0 || in_view[kRightSide] == 0;
  return expected[s] > 0 && in_view[s] >= 3 && (one_side ? 3 : 2) * in_view[s] >= expected[s];
}

std::optional<Side> OutlineFit::only_side() const {
  const bool left = in_view[kLeftSide] >= 3;
  const bool right = in_view[kRightSide] >= 3;
  if (left == right || expected[kRightSide] == 0) {
    return std::nullopt;
  }
  return left ? kLeftSide : kRightSide;
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

std::optional<OutlineFit> OutlineFitter::fit(const GreyView& image, const Outline& outline,
                                             const OutlineFitParams& params, const Pose2& start) {
  const double metres_per_px = metres_per_pixel(*camera_, start.position(), outline.height);
  const bool faint = params.expected_step < 8.0 * params.pixel_noise;
  // A narrow outline's opposite edge must stay out of the filter and the search.
  const double narrow_px = std::min(outline.width, outline.length) / metres_per_px;
  const int half_filter = std::clamp(static_cast<int>(narrow_px / 4.0), 1, faint || params.inside_brighter ? 4 : 2);
  int lines = 1;
  if (faint) {
    const double ratio = 2.5 * params.pixel_noise / (0.6 * std::max(params.expected_step, 1.0));
    lines = std::clamp(static_cast<int>(std::ceil(2.0 * ratio * ratio / half_filter)), 3, 12);
  }
  edges_.place(outline, metres_per_px, std::max(6.0, lines + 1.0), params.inside_brighter);
  const int widest = std::max(3, std::min(params.first_search_px, static_cast<int>(0.45 * narrow_px)));
  const std::array<Pass, 4> passes{
      {{widest, 8.0}, {std::min(widest, 6), 4.0}, {std::min(widest, 4), 2.0}, {std::min(widest, 4), 1.6}}};

  OutlineFit fit;
  Pose2 pose = start;
  double swelling = params.first_swelling;
  double taper = 0.0;
  OutlineMove move;
  double moved_px = 0.0;  // by the pass before
  const bool lit = params.inside_brighter;
  const bool has_many_points =
      outline.shape != FixtureShape::kRound && edges_.points_of(kLeftSide).size() >= kManyPoints;
  for (std::size_t pass = 0; pass < passes.size(); ++pass) {
    if (pass == 1 && lit && moved_px < kNearStart) {
      continue;
    }
    // A side that runs along the border is looked at anew: there a fraction of a pixel decides what is in view.
    const bool is_settled = pass + 1 == passes.size() && lit && moved_px < kSettled && !fit.only_side();
    const double cutoff = passes[pass].cutoff_px;
    EdgeSearch search{.search_px = passes[pass].search_px,
                      .half_filter = half_filter,
                      .lines = lines,
                      .least_edge = std::max(params.least_edge, pass == 0 ? 0.0 : kFaintest * fit.step),
                      .every = pass == 0 && lit && has_many_points ? kEveryAtFirst : 1};
    // The first pass tolerates a start that is off as a whole: residuals are judged against their side's median. So do
    // all for unlit fixtures: a joint of the ceiling beside one moves a whole side by its width and cannot always be
    // told from it.
    const double limit = pass == 0 ? 1e9 : params.inside_brighter ? kLargestLensError : kLargestSideOffset;
    std::array<double, kSides> centre_px{};
    const auto may_be_there = [&](int first_side, int last_side) {
      search.first_side = first_side;
      search.last_side = last_side;
      if (is_settled) {
        edges_.follow(move);
      } else {
        edges_.measure(image, outline, params, {pose, swelling, taper}, search);
      }
      for (int side = first_side; side <= last_side; ++side) {
        const auto points = edges_.points_of(side);
        const double centre = std::clamp(median_offset(points), -limit, limit);
        centre_px[static_cast<std::size_t>(side)] = centre;
        // The bloom of a lamp's side may reach beyond the border: then it says nothing, neither for nor against.
        const bool may_be_hidden = params.inside_brighter && pass > 0 && edges_.runs_along_border(side);
        const bool is_end = side == kFarEnd || side == kNearEnd;
        if (!has_few_edges(points, centre, cutoff, is_end ? kLeastOfEnd : kLeastShare,
                           may_be_hidden ? 1 : kLeastToRefute)) {
          continue;
        }
        if (may_be_hidden) {
          edges_.leave_out(side);
        } else if (!is_end) {
          return false;
        }
      }
      return true;
    };
    // Most guesses are refuted by one long side, at once: the others need not be looked at then.
    if (pass == 0 ? !may_be_there(kLeftSide, kLeftSide) || !may_be_there(kRightSide, kRightSide) ||
                        !may_be_there(kFarEnd, kNearEnd)
                  : !may_be_there(kLeftSide, kNearEnd)) {
      return std::nullopt;
    }

    // Priors: the swelling is about zero, and what no edge holds stays where it is.
    OutlineEquations equations;
    Matrix5d& information = equations.information;
    Vector5d& right_side = equations.right_side;
    const double sigma = params.edge_sigma_px * metres_per_px;
    const double free_along = std::max(outline.length, outline.width);
    information(0, 0) = information(1, 1) = sigma * sigma / (free_along * free_along);
    information(2, 2) = sigma * sigma / (kPi * kPi);
    information(3, 3) = sigma * sigma / (params.swelling_sigma * params.swelling_sigma);
    right_side(3) = -information(3, 3) * swelling;
    // one side cannot tell a turn from bloom that changes along it
    const bool one_side = outline.shape != FixtureShape::kRound &&
                          (edges_.count_in_view(kLeftSide) < 3 || edges_.count_in_view(kRightSide) < 3);
    const double taper_sigma = one_side ? std::min(kOneSideTaper, params.taper_sigma) : params.taper_sigma;
    information(4, 4) = sigma * sigma / (taper_sigma * taper_sigma);
    right_side(4) = -information(4, 4) * taper;
    const Matrix5d prior = information;

    fit.in_view.fill(0);
    fit.on_edge.fill(0);
    fit.expected.fill(0);
    fit.corner_in_view.fill(0);
    fit.side_step.fill(0.0);
    fit.corner_on_edge.fill(0);
    fit.visible_from = 0.5 * outline.length;
    fit.visible_to = -0.5 * outline.length;
    const bool round = outline.shape == FixtureShape::kRound;
    std::array<SideSums, kSides> sums{};
    double squares = 0.0;
    double steps = 0.0;
    int used = 0;
    for (const OutlinePoint& point : edges_.points()) {
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
      if (round) {
        Vector5d jacobian;
        jacobian << point.normal, 0.0, 1.0, point.place.x();
        information += weight * jacobian * jacobian.transpose();
        right_side += weight * point.offset * jacobian;
      } else {
        sums[side].add(weight, long_side ? point.place.x() : point.place.y(), point.offset);
      }
      ++fit.on_edge[side];
      fit.corner_on_edge[corner] += at_corner ? 1 : 0;
      squares += point.offset_px * point.offset_px;
      steps += point.step;
      fit.side_step[side] += point.step;
      ++used;
    }
    if (used < kLeastPoints) {
      return std::nullopt;
    }
    const double half_length = 0.5 * outline.length;
    sums[kLeftSide].add_to(equations, kLeftSide, 0.0);
    sums[kRightSide].add_to(equations, kRightSide, 0.0);
    sums[kFarEnd].add_to(equations, kFarEnd, half_length);
    sums[kNearEnd].add_to(equations, kNearEnd, -half_length);
    const Vector5d step = information.llt().solve(right_side);
    if (!step.allFinite() || std::abs(step(2)) > 0.5) {
      return std::nullopt;
    }
    const double c = std::cos(pose.theta);
    const double s = std::sin(pose.theta);
    pose = {pose.x + c * step(0) - s * step(1), pose.y + s * step(0) + c * step(1), wrap_angle(pose.theta + step(2))};
    const std::array<double, kSides> moved{step(1), -step(1), step(0), -step(0)};
    for (std::size_t side = 0; side < kSides; ++side) {
      fit.side_edge[side] = swelling + centre_px[side] * metres_per_px - moved[side];
    }
    move = {step.head<2>(), step(2), step(3), step(4)};
    moved_px = largest_move(outline, move) / metres_per_px;
    swelling += step(3);
    taper += step(4);

    fit.residual_px = std::sqrt(squares / used);
    fit.step = steps / used;
    for (std::size_t side = 0; side < kSides; ++side) {
      fit.side_step[side] /= std::max(fit.on_edge[side], 1);
    }
    if (pass + 1 == passes.size()) {
      const double edge_sigma = std::max(params.edge_sigma_px, fit.residual_px) * metres_per_px;
      const Matrix5d inverse = information.llt().solve(Matrix5d::Identity());
      // Edges that scatter say less; what is known beforehand says as much as ever.
      const Matrix5d scattered = edge_sigma * edge_sigma * (information - prior) + sigma * sigma * prior;
      fit.covariance = (inverse * scattered * inverse).topLeftCorner<3, 3>();
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
        // bloom is not quite the same on all sides, and a guess where too few of them are seen
        const double bloom = std::hypot(0.1 * swelling, 0.3 * edge_sigma * std::sqrt(inverse(3, 3)));
        fit.covariance(0, 0) += bloom * bloom;
        fit.covariance(1, 1) += bloom * bloom;
        fit.covariance(2, 2) += one_side ? 0.0 : 0.25 * bloom * bloom / (lever * lever);
      }
    }
  }
  fit.robot_from_outline = pose;
  fit.swelling = swelling;
  fit.metres_per_px = metres_per_px;
  return fit;
}

}  // namespace luminav
