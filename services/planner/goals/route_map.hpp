#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/planner/goals/suspected_obstacles.hpp"
#include "services/planner/path/route_planner.hpp"

namespace luminav {

/// What is known of the floor while a goal is under way: the mapper's grid and the suspected obstacles, and routes over
/// both.
class RouteMap {
 public:
  explicit RouteMap(const RoutePlannerParams& params) : params_(params), planner_(params) {}

  /// Takes over a new state of the grid, which must outlive the next one. `received` of `tiles` are there.
  void change(const OccupancyGrid& grid, int received, int tiles);
  /// Plans by these from now on.
  void set_zones(const std::vector<Zone>& zones);
  [[nodiscard]] bool is_complete() const { return grid_ != nullptr && received_ >= tiles_; }
  [[nodiscard]] int received() const { return received_; }
  [[nodiscard]] int tiles() const { return tiles_; }
  /// The grid or the suspected obstacles changed since the last refresh.
  [[nodiscard]] bool has_changed() const { return has_changed_; }

  void suspect(const SuspectedObstacle& obstacle, std::int64_t until);
  void drop_suspects();
  void expire_suspects(std::int64_t now) { has_changed_ |= suspects_.expire(now); }
  void restart_clock(std::int64_t now) { suspects_.restart_clock(now); }
  [[nodiscard]] const SuspectedObstacles& suspects() const { return suspects_; }

  /// Brings the configuration space up to date.
  void refresh();
  /// Plans over the space of the last refresh.
  [[nodiscard]] Route plan(const RouteRequest& request) { return planner_.plan(request); }
  /// Plans over the building's map alone: what sonars have drawn may go away.
  [[nodiscard]] Route plan_by_building(const RouteRequest& request) const;
  /// The zones through which a path by the building's map would lead if there were none, as "keep-out zone yard
  /// until 12:00, one-way zone lane"; "" where no path leads without them either.
  [[nodiscard]] std::string zones_in_the_way(const RouteRequest& request) const;
  /// Plans round the given obstacles and what the evidence is sure of: cells above `occupied_log_odds`, not widened
  /// beyond the robot's body.
  [[nodiscard]] Route plan_by_sure_evidence(const RouteRequest& request, double occupied_log_odds,
                                            const std::vector<SuspectedObstacle>& obstacles) const;

  /// Index of the first point of a path that is blocked, leaving out the points beside the robot at its start: these
  /// are the controller's business.
  [[nodiscard]] std::optional<std::size_t> first_blocked(const Polyline& points) const;
  /// The same for what is left of a path, whose second point may be anywhere near.
  [[nodiscard]] std::optional<std::size_t> first_blocked_of_rest(const Polyline& points) const;

  [[nodiscard]] const RoutePlannerParams& params() const { return params_; }
  [[nodiscard]] const ConfigurationSpace& space() const { return planner_.space(); }
  [[nodiscard]] const OccupancyGrid& grid() const { return *grid_; }
  /// True if only this robot's sonars tell where walls are: no building's map does.
  [[nodiscard]] bool is_drawn_by_robot() const { return params_.space.unknown_is_free; }
  /// Length [m] of a path, more of it where nobody has seen what is there.
  [[nodiscard]] double length_with_unknown(const Polyline& points) const;

 private:
  RoutePlannerParams params_;
  RoutePlanner planner_;
  SuspectedObstacles suspects_;
  const OccupancyGrid* grid_ = nullptr;
  int received_ = 0;
  int tiles_ = 0;
  bool has_changed_ = true;
};

}  // namespace luminav
