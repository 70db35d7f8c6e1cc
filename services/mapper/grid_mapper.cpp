#include "services/mapper/grid_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "services/common/building/distance_transform.hpp"
#include "services/common/geometry/seconds.hpp"
#include "services/mapper/sonar/surface_patch.hpp"

namespace luminav {
namespace {

constexpr double kPriorWidening = radians(2.0);  // [rad] added to a cone for the error of the believed heading
// [rad] a wall seen more obliquely throws the sound away: silence says nothing about it
constexpr double kSpecularIncidence = radians(20.0);
constexpr double kStandingGap = 1.5;  // [s] of silence: what is heard then is another thing
// Within this range of a disc anything is heard up to this angle, off its axis too: the cones of two discs leave a gap
// between them so near.
constexpr double kLobeRange = 0.45;           // [m]
constexpr double kLobeAngle = radians(40.0);  // [rad]
constexpr double kLobeLogOdds = 0.10;         // taken there
constexpr std::size_t kDisputePoses = 3;      // from which a wall must be seen through
constexpr double kDisputeSpacing = 0.5;       // [m] between them
constexpr double kViewAngle = radians(3.0);   // [rad] that a disc turns before it votes in the same place again
constexpr double kBesideDisc = 0.1;           // [m] nearer to a disc nothing can hide anything
constexpr double kSelfEcho = 0.3;             // [m] around the reading that may belong to the wall itself
constexpr double kRobotLogOdds = 1.0;         // the robot's own place is certain

std::vector<std::uint8_t> cells_near_walls(const OccupancyGrid& grid, double distance) {
  std::vector<bool> is_wall(grid.prior.size());
  std::transform(grid.prior.begin(), grid.prior.end(), is_wall.begin(),
                 [](Prior prior) { return prior == Prior::kOccupied; });
  const std::vector<float> squared = squared_distances_to(is_wall, static_cast<std::size_t>(grid.geometry.columns));
  std::vector<std::uint8_t> near(squared.size());
  std::transform(squared.begin(), squared.end(), near.begin(), [&](float cells) {
    return std::sqrt(static_cast<double>(cells)) * grid.geometry.resolution <= distance + 1e-9 ? 1 : 0;
  });
  return near;
}

}  // namespace

GridMapper::GridMapper(const GridMapperParams& params, const PriorMap& prior, int discs)
    : params_(params),
      grid_(prior.geometry),
      free_space_(params.sonar),
      filter_(params.filter, discs),
      standing_(params.standing_time, kStandingGap) {
  if (prior.cells.size() != prior.geometry.size() || prior.geometry.size() == 0) {
    throw std::invalid_argument("grid mapper: the prior map is empty");
  }
  grid_.prior = prior.cells;
  views_.resize(static_cast<std::size_t>(discs));
  near_wall_ = cells_near_walls(grid_, params_.prior_tolerance);
  const auto tiles = static_cast<std::size_t>(grid_.tile_columns()) * static_cast<std::size_t>(grid_.tile_rows());
  touched_.assign(tiles, 0);
  has_evidence_.assign(tiles, 0);
}

void GridMapper::integrate(const DiscReading& reading) {
  const SonarModelParams& sonar = params_.sonar;
  if (!(reading.range >= sonar.minimum_range) || !std::isfinite(reading.range)) {
    return;
  }
  const bool has_echo = reading.has_echo && reading.range < sonar.maximum_range - 0.01;
  const BeamReading beam{reading.world_from_sonar, reading.range, has_echo};
  const SliceRanges visible = visible_ranges(beam);
  free_space_.apply(beam, visible, grid_);
  look_beside(reading);
  if (has_echo) {
    const Eigen::Vector2d end = reading.world_from_sonar * Eigen::Vector2d(reading.range, 0.0);
    if (filter_.confirm(reading.disc, reading.utime, end, reading.range)) {
      dispute_walls(reading);
      if (reading.range <= sonar.occupied_range) {
        vote_occupied(reading, visible);
      }
    }
  }
  const double reach =
      std::min({has_echo ? reading.range : sonar.free_range, std::max(sonar.free_range, sonar.occupied_range)});
  touch(reading.world_from_sonar * Eigen::Vector2d(0.5 * reach, 0.0), 0.5 * reach + 2.0 * grid_.geometry.resolution);
}

SliceRanges GridMapper::visible_ranges(const BeamReading& beam) const {
  const GridGeometry& geometry = grid_.geometry;
  const double max = beam.has_echo ? beam.range : params_.sonar.no_echo_range;
  const double step = 0.7 * geometry.resolution;
  // What is heard from so far away was often thrown there by a mirror: in an office 2 to 3 of 100 cells in front of
  // such an echo are walls, ten times as many as in front of one from 1.5 m. It takes away no more than silence.
  const bool says_little = !beam.has_echo || beam.range > params_.mirror_range;
  SliceRanges ranges;
  for (int slice = 0; slice < kSlices; ++slice) {
    double& range = ranges[static_cast<std::size_t>(slice)];
    range = params_.sonar.maximum_range;
    const double off_axis = ((slice + 0.5) / kSlices * 2.0 - 1.0) * params_.sonar.half_angle;
    const double angle = beam.world_from_sonar.theta + off_axis;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    Cell last{-1, -1};
    for (double r = kBesideDisc; r < max; r += step) {
      const Cell cell = geometry.cell_at(beam.world_from_sonar.position() + r * direction);
      if (!geometry.contains(cell)) {
        break;
      }
      const bool is_wall = grid_.prior[geometry.index(cell)] == Prior::kOccupied;
      if (cell == last || (!is_wall && !is_occupied(cell))) {
        continue;
      }
      last = cell;
      if (!is_wall && !has_stood(geometry.index(cell))) {
        continue;
      }
      if (!is_wall) {
        const std::optional<double> incidence = incidence_at(cell, direction);
        const bool may_be_mirror = says_little && grid_.prior[geometry.index(cell)] == Prior::kUnknown;
        if (incidence ? *incidence <= kSpecularIncidence : !may_be_mirror) {
          continue;  // it would have answered: it may have gone
        }
      }
      range = r;
      break;
    }
  }
  return ranges;
}

std::optional<double> GridMapper::incidence_at(const Cell& cell, const Eigen::Vector2d& direction) const {
  SurfacePatch around;
  for (int dr = -SurfacePatch::kReach; dr <= SurfacePatch::kReach; ++dr) {
    for (int dc = -SurfacePatch::kReach; dc <= SurfacePatch::kReach; ++dc) {
      const Cell near{cell.column + dc, cell.row + dr};
      if (!grid_.geometry.contains(near)) {
        continue;
      }
      const std::size_t i = grid_.geometry.index(near);
      if (grid_.prior[i] == Prior::kOccupied || (is_occupied(near) && has_stood(i))) {
        around.add(dc, dr);
      }
    }
  }
  std::optional<double> along = around.direction();
  if (!along) {
    along = around.connected_to_middle().direction();
  }
  if (!along) {
    return std::nullopt;
  }
  const double across = std::abs(-std::sin(*along) * direction.x() + std::cos(*along) * direction.y());
  return std::acos(std::min(1.0, across));
}

void GridMapper::look_beside(const DiscReading& reading) {
  const double reach = std::min(kLobeRange, reading.range - params_.sonar.free_margin);
  if (reach <= 0.0) {
    return;
  }
  const Eigen::Vector2d disc = reading.world_from_sonar.position();
  const Cell low = grid_.geometry.cell_at(disc - Eigen::Vector2d(reach, reach));
  const Cell high = grid_.geometry.cell_at(disc + Eigen::Vector2d(reach, reach));
  for (int row = std::max(0, low.row); row <= std::min(high.row, grid_.geometry.rows - 1); ++row) {
    for (int column = std::max(0, low.column); column <= std::min(high.column, grid_.geometry.columns - 1); ++column) {
      const std::size_t i = grid_.geometry.index({column, row});
      if (grid_.evidence[i] <= 0 || grid_.prior[i] != Prior::kFree || near_wall_[i] != 0) {
        continue;
      }
      const Eigen::Vector2d offset = grid_.geometry.centre_of({column, row}) - disc;
      const double off_axis = wrap_angle(std::atan2(offset.y(), offset.x()) - reading.world_from_sonar.theta);
      if (offset.norm() <= reach && std::abs(off_axis) <= kLobeAngle) {
        grid_.evidence[i] = static_cast<std::int8_t>(std::max(0, grid_.evidence[i] - to_evidence(kLobeLogOdds)));
      }
    }
  }
}

void GridMapper::vote_occupied(const DiscReading& reading, const SliceRanges& visible) {
  const BeamReading beam{reading.world_from_sonar, reading.range, true};
  std::vector<ArcCell> arc = cells_of_echo(params_.sonar, grid_.geometry, beam, kPriorWidening);
  // what lies behind something opaque cannot have answered
  std::erase_if(arc, [&](const ArcCell& candidate) {
    return visible[static_cast<std::size_t>(candidate.slice)] < reading.range - params_.sonar.free_margin;
  });
  bool wall_explains = false;
  bool known_explains = false;
  double uncharted = 0.0;  // odds of all cells of which the building's map knows nothing
  for (const ArcCell& candidate : arc) {
    const std::size_t i = grid_.geometry.index(candidate.cell);
    wall_explains = wall_explains || near_wall_[i] != 0;
    known_explains = known_explains || is_occupied(candidate.cell);
    if (grid_.prior[i] == Prior::kUnknown) {
      uncharted += candidate.weight * odds_of(grid_.evidence[i], reading.range);
    }
  }
  const bool is_new = is_new_view(reading);
  const double far_share = reading.range > params_.mirror_range ? params_.mirror_share : 1.0;
  for (const ArcCell& candidate : arc) {
    const std::size_t i = grid_.geometry.index(candidate.cell);
    if (wall_explains) {
      if (grid_.prior[i] == Prior::kOccupied || grid_.prior[i] == Prior::kDisputed) {
        add(candidate.cell, params_.sonar.occupied_log_odds * candidate.weight);
        disputes_.erase(i);
      }
      continue;
    }
    if (grid_.prior[i] == Prior::kUnknown) {
      if (is_new && uncharted > 0.0) {  // the echo came from one of them, most likely from where others came from
        const double share = candidate.weight * odds_of(grid_.evidence[i], reading.range) / uncharted;
        add(candidate.cell, far_share * params_.sonar.occupied_log_odds * std::min(1.0, params_.surface_cells * share));
        if (is_occupied(candidate.cell)) {
          forget_behind(reading.world_from_sonar.position(), candidate.cell);
        }
      }
      continue;
    }
    const double share = known_explains && !is_occupied(candidate.cell) ? params_.explained_share : 1.0;
    add_echo(candidate.cell, params_.sonar.occupied_log_odds * candidate.weight * share, reading.utime);
    if (grid_.prior[i] == Prior::kDisputed && is_occupied(candidate.cell)) {
      grid_.prior[i] = Prior::kOccupied;
      disputes_.erase(i);
    }
  }
}

// Oblique walls are mirrors: before a wall was drawn, echoes of what they show were placed behind it, and the cells
// there were called free. What is true of it will be seen again from the other side.
void GridMapper::forget_behind(const Eigen::Vector2d& disc, const Cell& wall) {
  const Eigen::Vector2d centre = grid_.geometry.centre_of(wall);
  const Eigen::Vector2d step = grid_.geometry.resolution * (centre - disc).normalized();
  const int depth = std::max(1, static_cast<int>(std::lround(params_.wall_thickness / grid_.geometry.resolution)));
  for (int k = 1; k <= depth; ++k) {
    const Cell behind = grid_.geometry.cell_at(centre + k * step);
    if (grid_.geometry.contains(behind)) {
      std::int8_t& evidence = grid_.evidence[grid_.geometry.index(behind)];
      evidence = std::max(evidence, std::int8_t{0});
    }
  }
}

double GridMapper::odds_of(std::int8_t evidence, double range) const {
  const double max = range > params_.narrow_range ? params_.sonar.max_log_odds : params_.known_log_odds;
  return std::exp(params_.arc_sharpness * std::min(evidence / kEvidencePerLogOdds, max));
}

bool GridMapper::is_new_view(const DiscReading& reading) {
  View& last = views_[static_cast<std::size_t>(reading.disc)];
  const bool is_new =
      (last.world_from_sonar.position() - reading.world_from_sonar.position()).norm() >= params_.view_distance ||
      std::abs(wrap_angle(last.world_from_sonar.theta - reading.world_from_sonar.theta)) >= kViewAngle ||
      std::abs(last.range - reading.range) >= params_.view_distance;
  if (is_new) {
    last = {reading.world_from_sonar, reading.range};
  }
  return is_new;
}

void GridMapper::dispute_walls(const DiscReading& reading) {
  const double end = std::min(reading.range - kSelfEcho, params_.dispute_range);
  const double step = 0.5 * grid_.geometry.resolution;
  for (double range = 0.0; range < end; range += step) {
    const Cell cell = grid_.geometry.cell_at(reading.world_from_sonar * Eigen::Vector2d(range, 0.0));
    if (!grid_.geometry.contains(cell)) {
      return;
    }
    const std::size_t i = grid_.geometry.index(cell);
    if (grid_.prior[i] != Prior::kOccupied) {
      continue;
    }
    const double theta = reading.world_from_sonar.theta;
    const std::optional<double> incidence = incidence_at(cell, {std::cos(theta), std::sin(theta)});
    if (incidence && *incidence > kSpecularIncidence) {
      return;  // a mirror: what seems to lie behind it lies elsewhere
    }
    std::vector<Eigen::Vector2d>& positions = disputes_[i];
    const Eigen::Vector2d position = reading.world_from_robot.position();
    if (std::any_of(positions.begin(), positions.end(),
                    [&](const Eigen::Vector2d& other) { return (other - position).norm() < kDisputeSpacing; })) {
      continue;
    }
    positions.push_back(position);
    if (positions.size() >= kDisputePoses) {
      grid_.prior[i] = Prior::kDisputed;
      disputes_.erase(i);
    }
  }
}

void GridMapper::mark_robot(const Pose2& world_from_robot) {
  const Cell centre = grid_.geometry.cell_at(world_from_robot.position());
  const int reach = static_cast<int>(std::ceil(params_.robot_radius / grid_.geometry.resolution));
  for (int row = centre.row - reach; row <= centre.row + reach; ++row) {
    for (int column = centre.column - reach; column <= centre.column + reach; ++column) {
      const Cell cell{column, row};
      if (grid_.geometry.contains(cell) &&
          (grid_.geometry.centre_of(cell) - world_from_robot.position()).norm() <= params_.robot_radius) {
        add(cell, -kRobotLogOdds);
      }
    }
  }
  touch(world_from_robot.position(), params_.robot_radius);
}

void GridMapper::decay(std::int64_t utime) {
  if (params_.decay_time <= 0.0) {
    return;
  }
  const int levels = std::max(1, to_evidence(params_.sonar.max_log_odds) - to_evidence(params_.occupied_log_odds));
  const auto step = microseconds_of(params_.decay_time) / levels;
  if (decayed_until_ == 0 || utime < decayed_until_ || utime - decayed_until_ > 10 * step) {
    decayed_until_ = utime;  // a new session, or a long silence in which nothing could be seen
    return;
  }
  if (utime - decayed_until_ < step) {
    return;
  }
  decayed_until_ += step;
  const std::int8_t threshold = to_evidence(params_.occupied_log_odds);
  for (std::size_t tile = 0; tile < has_evidence_.size(); ++tile) {
    if (has_evidence_[tile] == 0) {
      continue;
    }
    const int first_column = static_cast<int>(tile) % grid_.tile_columns() * kTileSide;
    const int first_row = static_cast<int>(tile) / grid_.tile_columns() * kTileSide;
    for (int row = first_row; row < std::min(first_row + kTileSide, grid_.geometry.rows); ++row) {
      for (int column = first_column; column < std::min(first_column + kTileSide, grid_.geometry.columns); ++column) {
        const std::size_t i = grid_.geometry.index({column, row});
        if (grid_.evidence[i] > 0 && grid_.prior[i] == Prior::kFree) {
          --grid_.evidence[i];
          if (grid_.evidence[i] == threshold) {
            touched_[tile] = 1;
          }
        }
      }
    }
  }
}

void GridMapper::clear_evidence() {
  std::fill(grid_.evidence.begin(), grid_.evidence.end(), std::int8_t{0});
  std::replace(grid_.prior.begin(), grid_.prior.end(), Prior::kDisputed, Prior::kOccupied);
  std::fill(touched_.begin(), touched_.end(), std::uint8_t{1});
  std::fill(has_evidence_.begin(), has_evidence_.end(), std::uint8_t{0});
  disputes_.clear();
  filter_.clear();
  standing_.clear();
  std::fill(views_.begin(), views_.end(), View{});
}

bool GridMapper::is_occupied(const Cell& cell) const {
  return grid_.evidence[grid_.geometry.index(cell)] > to_evidence(params_.occupied_log_odds);
}

PriorMap GridMapper::combined() const {
  const std::int8_t occupied = to_evidence(params_.occupied_log_odds);
  const auto free = static_cast<std::int8_t>(-occupied);
  PriorMap map{grid_.geometry, std::vector<Prior>(grid_.geometry.size(), Prior::kUnknown)};
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (grid_.prior[i] == Prior::kOccupied || grid_.prior[i] == Prior::kDisputed || grid_.evidence[i] > occupied) {
      map.cells[i] = Prior::kOccupied;
    } else if (grid_.prior[i] == Prior::kFree || grid_.evidence[i] < free) {
      map.cells[i] = Prior::kFree;
    }
  }
  return map;
}

std::vector<int> GridMapper::take_touched_tiles() {
  std::vector<int> tiles;
  for (std::size_t tile = 0; tile < touched_.size(); ++tile) {
    if (touched_[tile] != 0) {
      tiles.push_back(static_cast<int>(tile));
      touched_[tile] = 0;
    }
  }
  return tiles;
}

bool GridMapper::restore_evidence(const OccupancyGrid& kept) {
  if (!(kept.geometry == grid_.geometry) || kept.evidence.size() != grid_.evidence.size()) {
    return false;
  }
  grid_.evidence = kept.evidence;
  std::fill(touched_.begin(), touched_.end(), std::uint8_t{1});
  std::fill(has_evidence_.begin(), has_evidence_.end(), std::uint8_t{1});
  return true;
}

void GridMapper::touch(const Eigen::Vector2d& centre, double radius) {
  const Cell low = grid_.geometry.cell_at(centre - Eigen::Vector2d(radius, radius));
  const Cell high = grid_.geometry.cell_at(centre + Eigen::Vector2d(radius, radius));
  const int first_row = std::max(0, low.row) / kTileSide;
  const int last_row = std::min(grid_.geometry.rows - 1, high.row) / kTileSide;
  const int first_column = std::max(0, low.column) / kTileSide;
  const int last_column = std::min(grid_.geometry.columns - 1, high.column) / kTileSide;
  if (high.row < 0 || high.column < 0 || low.row >= grid_.geometry.rows || low.column >= grid_.geometry.columns) {
    return;
  }
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const std::size_t tile = static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.tile_columns()) +
                               static_cast<std::size_t>(column);
      touched_[tile] = 1;
      has_evidence_[tile] = 1;
    }
  }
}

void GridMapper::add(const Cell& cell, double log_odds) {
  std::int8_t& value = grid_.evidence[grid_.geometry.index(cell)];
  const int sum = value + to_evidence(log_odds);
  value = static_cast<std::int8_t>(
      std::clamp<int>(sum, to_evidence(params_.sonar.min_log_odds), to_evidence(params_.sonar.max_log_odds)));
}

void GridMapper::add_echo(const Cell& cell, double log_odds, std::int64_t utime) {
  const std::size_t i = grid_.geometry.index(cell);
  const std::int8_t before = grid_.evidence[i];
  const bool stands = grid_.prior[i] != Prior::kFree || standing_.hear(i, utime, before <= 0);
  add(cell, log_odds);
  if (!stands) {
    grid_.evidence[i] = std::min(grid_.evidence[i], std::max(before, to_evidence(kPassingLogOdds)));
  }
}

bool GridMapper::has_stood(std::size_t cell) const {
  return grid_.prior[cell] != Prior::kFree || grid_.evidence[cell] > to_evidence(kPassingLogOdds);
}

}  // namespace luminav
