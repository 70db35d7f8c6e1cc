#include "services/planner/goals/route_map.hpp"

#include <fmt/format.h>

namespace luminav {
namespace {

constexpr double kBesideRobot = 0.35;  // [m] of the path
constexpr double kUnknownRatio =
    3.0;  // a path through what nobody has seen counts so many times as long: walls are there

}  // namespace

void RouteMap::change(const OccupancyGrid& grid, int received, int tiles) {
  grid_ = &grid;
  received_ = received;
  tiles_ = tiles;
  has_changed_ = true;
}

void RouteMap::set_zones(const std::vector<Zone>& zones) {
  params_.space.zones = zones;
  planner_ = RoutePlanner(params_);
  if (grid_ != nullptr) {
    planner_.set_grid(*grid_, suspects_.all());
  }
  has_changed_ = true;  // paths are to be looked at again
}

void RouteMap::suspect(const SuspectedObstacle& obstacle, std::int64_t until) {
  suspects_.add(obstacle, until);
  has_changed_ = true;
}

void RouteMap::drop_suspects() {
  suspects_.clear();
  has_changed_ = true;
}

void RouteMap::refresh() {
  if (has_changed_) {
    planner_.set_grid(*grid_, suspects_.all());
    has_changed_ = false;
  }
}

Route RouteMap::plan_by_building(const RouteRequest& request) const {
  RoutePlanner planner(params_);
  planner.set_grid(*grid_, {}, false);
  return planner.plan(request);
}

std::string RouteMap::zones_in_the_way(const RouteRequest& request) const {
  RoutePlannerParams free = params_;
  free.space.zones.clear();
  RoutePlanner planner(free);
  planner.set_grid(*grid_, {}, false);
  const Polyline points = planner.plan(request).points;
  std::string names;
  for (const Zone& zone : params_.space.zones) {
    const LaneMap lane({zone}, grid_->geometry);
    bool is_in_the_way = false;
    for (std::size_t i = 1; i < points.size() && !is_in_the_way; ++i) {
      const bool is_inside = contains(zone.polygon, points[i]);
      is_in_the_way = (zone.kind == ZoneKind::kKeepOut &&
                       (is_inside || distance_to_edge(zone.polygon, points[i]) <= params_.space.hard_radius)) ||
                      lane.is_against(points[i - 1], points[i]);
    }
    if (is_in_the_way) {
      names += fmt::format("{}{} zone {}{}", names.empty() ? "" : ", ", name_of(zone.kind), zone.name, until_of(zone));
    }
  }
  return names;
}

Route RouteMap::plan_by_sure_evidence(const RouteRequest& request, double occupied_log_odds,
                                      const std::vector<SuspectedObstacle>& obstacles) const {
  RoutePlannerParams sceptical = params_;
  sceptical.space.hard_radius = params_.body_radius;
  sceptical.space.occupied_log_odds = occupied_log_odds;
  RoutePlanner planner(sceptical);
  planner.set_grid(*grid_, obstacles);
  return planner.plan(request);
}

std::optional<std::size_t> RouteMap::first_blocked(const Polyline& points) const {
  return planner_.first_blocked(points, static_cast<std::size_t>(kBesideRobot / params_.shaping.spacing) + 1);
}

std::optional<std::size_t> RouteMap::first_blocked_of_rest(const Polyline& points) const {
  std::size_t beside = 0;
  while (beside < points.size() && (points[beside] - points.front()).norm() < kBesideRobot) {
    ++beside;
  }
  return planner_.first_blocked(points, beside);
}

double RouteMap::length_with_unknown(const Polyline& points) const {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = (points[i] - points[i - 1]).norm();
    const Cell cell = grid_->geometry.cell_at(points[i]);
    const std::size_t k = grid_->geometry.index(cell);
    const bool is_unknown =
        !grid_->geometry.contains(cell) || (grid_->prior[k] == Prior::kUnknown && grid_->evidence[k] == 0);
    length += is_unknown ? kUnknownRatio * step : step;
  }
  return length;
}

}  // namespace luminav
