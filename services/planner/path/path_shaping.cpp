#include "services/planner/path/path_shaping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace luminav {
namespace {

int samples_of(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * space.geometry().resolution))));
}

/// Whether the rectangle of cells between two is passable, where that is a small one.
bool is_small_and_clear(const ConfigurationSpace& space, const Cell& a, const Cell& b) {
  constexpr int kMaxCells = 9;
  const Cell low{std::min(a.column, b.column), std::min(a.row, b.row)};
  const Cell high{std::max(a.column, b.column), std::max(a.row, b.row)};
  return space.geometry().contains(low) && space.geometry().contains(high) &&
         (high.column - low.column + 1) * (high.row - low.row + 1) <= kMaxCells &&
         space.passable().has_all({low.column, high.column + 1, low.row, high.row + 1});
}

/// Replaces pieces of the chain by straight lines, farthest first, while they cost no more.
Polyline shortened(const ConfigurationSpace& space, const PathShapingParams& params, const Polyline& chain) {
  std::vector<double> cost(chain.size(), 0.0);  // from the first point
  for (std::size_t i = 1; i < chain.size(); ++i) {
    cost[i] = cost[i - 1] + cost_of(space, chain[i - 1], chain[i]);
  }
  Polyline result = {chain.front()};
  std::size_t at = 0;
  while (at + 1 < chain.size()) {
    std::size_t next = at + 1;
    // doubling finds the far end of long straight pieces with few tries; then one by one from there
    for (std::size_t stride = 64; stride >= 1; stride /= 2) {
      while (next + stride < chain.size()) {
        const std::size_t candidate = next + stride;
        const bool short_enough = (chain[candidate] - chain[at]).norm() <= params.shortcut_length;
        if (!short_enough || !is_clear(space, chain[at], chain[candidate]) ||
            cost_of(space, chain[at], chain[candidate]) > params.shortcut_slack * (cost[candidate] - cost[at])) {
          break;
        }
        next = candidate;
      }
    }
    result.push_back(chain[next]);
    at = next;
  }
  return result;
}

/// `is_clear` of a piece whose start is known to lie in a cell.
bool is_clear_from(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Cell& cell,
                   const Eigen::Vector2d& to) {
  if (!space.lanes().empty() && space.lanes().is_against(from, to)) {
    return false;
  }
  // of a short line every sample lies in the rectangle of its ends; rounding keeps their order
  if (is_small_and_clear(space, cell, space.geometry().cell_at(from + (to - from)))) {
    return true;
  }
  const int samples = samples_of(space, from, to);
  for (int i = 0; i <= samples; ++i) {
    if (space.is_blocked(space.geometry().cell_at(from + (to - from) * (static_cast<double>(i) / samples)))) {
      return false;
    }
  }
  return true;
}

/// The same path in pieces of at most `max` [m]: unlike `resampled` it keeps every corner.
Polyline divided(const Polyline& points, double max) {
  Polyline result = {points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d piece = points[i] - points[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(piece.norm() / max)));
    for (int k = 1; k <= parts; ++k) {
      result.push_back(points[i - 1] + piece * (static_cast<double>(k) / parts));
    }
  }
  return result;
}

/// What a band feels in one round, and how often.
struct Relaxation {
  int rounds = 0;
  double tension = 0.0;  // share of the distance to the middle of the neighbours
  double push = 0.0;     // [m] where an obstacle is nearest
};

/// How far obstacles push a point in one round [m]: away from the nearest one, the nearer the more.
Eigen::Vector2d push_of(const ConfigurationSpace& space, double max, const Eigen::Vector2d& p) {
  const double range = 1.2;  // [m] obstacles farther away do not push
  const double h = space.geometry().resolution;
  const double depth = std::max(0.0, 1.0 - space.clearance_at(p) / range);
  if (depth <= 0.0) {
    return Eigen::Vector2d::Zero();
  }
  const Eigen::Vector2d x(h, 0.0);
  const Eigen::Vector2d y(0.0, h);
  const Eigen::Vector2d difference(space.clearance_at(p + x) - space.clearance_at(p - x),
                                   space.clearance_at(p + y) - space.clearance_at(p - y));
  const Eigen::Vector2d gradient =
      difference / (2.0 * h);  // of length 1 where one obstacle is nearest, 0 in the middle between two
  return max * depth * gradient;
}

void relax(const ConfigurationSpace& space, const Relaxation& relaxation, Polyline& band) {
  constexpr double kStill =
      5e-4;  // [m] a point that moved less stays, until a neighbour moves: most of a path is straight
  std::vector<std::uint8_t> moves(band.size(), 1);
  std::vector<std::uint8_t> moved_last(band.size(), 1);
  std::vector<Cell> cells;  // of the points
  for (const Eigen::Vector2d& point : band) {
    cells.push_back(space.geometry().cell_at(point));
  }
  Polyline pushes(band.size());  // [m] of where each point is
  std::vector<std::uint8_t> is_pushed(band.size(), 0);
  for (int round = 0; round < relaxation.rounds; ++round) {
    for (std::size_t i = 1; i + 1 < band.size(); ++i) {
      // in one round the points before have moved already
      if (moves[i - 1] == 0 && moved_last[i] == 0 && moved_last[i + 1] == 0) {
        moves[i] = 0;
        continue;
      }
      const Eigen::Vector2d pull = relaxation.tension * (0.5 * (band[i - 1] + band[i + 1]) - band[i]);
      if (is_pushed[i] == 0) {
        pushes[i] = push_of(space, relaxation.push, band[i]);
        is_pushed[i] = 1;
      }
      const Eigen::Vector2d moved = band[i] + pull + pushes[i];
      moves[i] = 0;
      if ((moved - band[i]).squaredNorm() <= kStill * kStill ||
          !is_clear_from(space, band[i - 1], cells[i - 1], moved)) {
        continue;
      }
      const Cell cell = space.geometry().cell_at(moved);
      if (is_clear_from(space, moved, cell, band[i + 1])) {
        band[i] = moved;
        cells[i] = cell;
        moves[i] = 1;
        is_pushed[i] = 0;
      }
    }
    moves.front() = moves.back() = 0;
    moved_last = moves;
  }
}

}  // namespace

double cost_of(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int samples = samples_of(space, from, to);
  double price = 0.0;
  for (int i = 0; i < samples; ++i) {
    price += space.price_at(from + (to - from) * ((i + 0.5) / samples));
  }
  return (to - from).norm() * price / samples;
}

double cost_of(const ConfigurationSpace& space, const Polyline& points) {
  double cost = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    cost += cost_of(space, points[i - 1], points[i]);
  }
  return cost;
}

bool is_clear(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return is_clear_from(space, from, space.geometry().cell_at(from), to);
}

bool is_clear(const ConfigurationSpace& space, const Polyline& points) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!is_clear(space, points[i - 1], points[i])) {
      return false;
    }
  }
  return true;
}

double polyline_length(const Polyline& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += (points[i] - points[i - 1]).norm();
  }
  return length;
}

Polyline resampled(const Polyline& points, double spacing) {
  const double length = polyline_length(points);
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / spacing)));
  Polyline result = {points.front()};
  std::size_t segment = 1;
  double before = 0.0;  // length up to the segment
  for (int k = 1; k < pieces; ++k) {
    const double wanted = length * k / pieces;
    while (segment + 1 < points.size() && before + (points[segment] - points[segment - 1]).norm() < wanted) {
      before += (points[segment] - points[segment - 1]).norm();
      ++segment;
    }
    const double size = (points[segment] - points[segment - 1]).norm();
    const double fraction = size > 0.0 ? std::min(1.0, (wanted - before) / size) : 0.0;
    result.push_back(points[segment - 1] + fraction * (points[segment] - points[segment - 1]));
  }
  result.push_back(points.back());
  return result;
}

Polyline shape_path(const ConfigurationSpace& space, const PathShapingParams& params, const Polyline& chain) {
  if (chain.size() < 2) {
    return resampled(chain, params.spacing);
  }
  const Polyline straight = shortened(space, params, chain);
  // The band moves as heat spreads: of twice the spacing, and pushed four times as hard, a round takes it as far as
  // four.
  constexpr int kFasterBy = 4;
  constexpr int kFineRounds = 4;
  const int coarse_rounds = std::max(0, params.smoothing_rounds - kFineRounds) / kFasterBy;
  Polyline coarse = resampled(straight, 2.0 * params.spacing);
  relax(space, {coarse_rounds, params.tension, kFasterBy * params.push}, coarse);
  Polyline band = resampled(coarse, params.spacing);
  int rounds = params.smoothing_rounds - kFasterBy * coarse_rounds;
  if (!is_clear(space, band)) {
    // the long pieces cut a corner
    band = resampled(straight, params.spacing);
    rounds = params.smoothing_rounds;
  }
  relax(space, {rounds, params.tension, params.push}, band);
  const Polyline shaped = resampled(band, params.spacing);
  if (is_clear(space, shaped)) {
    return keep_to_side(space, params.keep_side, shaped);
  }
  return is_clear(space, straight) ? divided(straight, params.spacing) : shaped;
}

}  // namespace luminav
