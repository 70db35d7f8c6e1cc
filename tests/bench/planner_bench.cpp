#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "services/planner/path/route_planner.hpp"
#include "services/planner/search/cost_field.hpp"
#include "services/planner/search/tile_cost_field.hpp"
#include "services/planner/space/configuration_space.hpp"
#include "tests/unit/planner/office_grid.hpp"

// The office floors of the performance page, 0.1 m a cell; `fine` is the one of 4000 x 4000 cells of 0.025 m. Each run
// checks its result against what the peers agree on before any time is taken.

namespace luminav {
namespace {

constexpr double kRadius = 0.25;  // [m] of the robot

struct Office {
  int side;
  double resolution;
  std::uint64_t hash;
  std::int64_t free;     // after expansion
  std::int64_t reached;  // 8-connected from the goal
  std::uint32_t octile;  // cost from start to goal, 5 and 7 a step
};

const Office& office_of(int side) {
  static const std::map<int, Office> offices = {
      {200, {200, 0.1, 0x6516450895bfb1d3ULL, 29273, 29273, 1562}},
      {1000, {1000, 0.1, 0xc471d0532145fd35ULL, 646113, 646112, 9274}},
      {4000, {4000, 0.1, 0xb2e2347e21cfa48eULL, 10265046, 10264399, 37897}},
      {4001, {4000, 0.025, 0xa9b7f255cff90485ULL, 9567875, 0, 0}},
  };
  return offices.at(side);
}

void require(bool holds, const std::string& what) {
  if (!holds) {
    throw std::runtime_error("not the agreed workload or result: " + what);
  }
}

OccupancyGrid grid_of(const Office& office) {
  const std::vector<std::uint8_t> cells = office_grid(office.side, office.resolution);
  require(fnv1a(cells) == office.hash, "hash of the grid");
  OccupancyGrid grid({office.resolution, {0.0, 0.0}, office.side, office.side});
  std::transform(cells.begin(), cells.end(), grid.prior.begin(),
                 [](std::uint8_t cell) { return cell != 0 ? Prior::kOccupied : Prior::kFree; });
  return grid;
}

/// weight 0: every free cell costs the same, as with the peers
ConfigurationSpaceParams params_of(double clearance_weight) {
  ConfigurationSpaceParams params;
  params.hard_radius = kRadius;
  params.clearance_weight = clearance_weight;
  return params;
}

Cell start_of(const Office& office) {
  const int cell = static_cast<int>(std::lround(1.0 / office.resolution));
  return {cell, cell};
}

Cell goal_of(const Office& office) {
  const int cell = office.side - 1 - start_of(office).column;
  return {cell, cell};
}

void cspace(benchmark::State& state) {
  const Office& office = office_of(static_cast<int>(state.range(0)));
  const OccupancyGrid grid = grid_of(office);
  BitGrid solid(office.side, office.side);
  for (int row = 0; row < office.side; ++row) {
    for (int column = 0; column < office.side; ++column) {
      if (grid.prior[grid.geometry.index({column, row})] == Prior::kOccupied) {
        solid.set({column, row});
      }
    }
  }
  BitGrid blocked(office.side, office.side);
  dilate(solid, kRadius / office.resolution, 0, office.side, blocked);
  require(static_cast<std::int64_t>(grid.geometry.size()) - blocked.count() == office.free, "free cells");
  for (auto _ : state) {
    // from the live grid, as the planner has it
    ConfigurationSpace space(params_of(0.0), grid, {});
    benchmark::DoNotOptimize(space.passable().row(0));
  }
}

void cspace_opencv(benchmark::State& state) {
  const Office& office = office_of(static_cast<int>(state.range(0)));
  const std::vector<std::uint8_t> cells = office_grid(office.side, office.resolution);
  cv::setNumThreads(1);
  const cv::Mat solid(office.side, office.side, CV_8U, const_cast<std::uint8_t*>(cells.data()));
  const int reach = static_cast<int>(kRadius / office.resolution + 1e-9);
  cv::Mat disc(2 * reach + 1, 2 * reach + 1, CV_8U);
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      disc.at<std::uint8_t>(row + reach, column + reach) =
          std::hypot(row, column) * office.resolution <= kRadius + 1e-9 ? 1 : 0;
    }
  }
  cv::Mat wide;
  cv::dilate(solid, wide, disc);
  require(static_cast<std::int64_t>(cells.size()) - cv::countNonZero(wide) == office.free, "free cells");
  for (auto _ : state) {
    cv::dilate(solid, wide, disc);
    benchmark::DoNotOptimize(wide.data);
  }
}

std::uint32_t octile_cost(const std::vector<std::size_t>& path, int columns) {
  std::uint32_t cost = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const auto step = static_cast<std::int64_t>(path[i]) - static_cast<std::int64_t>(path[i - 1]);
    cost += std::abs(step) == 1 || std::abs(step) == columns ? 5 : 7;
  }
  return cost;
}

/// The same by the wave of tiles, whose ways are a little longer than the shortest.
void plan(benchmark::State& state) {
  const Office& office = office_of(static_cast<int>(state.range(0)));
  const OccupancyGrid grid = grid_of(office);
  TileCostField tiles;
  const Cell goals[] = {goal_of(office)};
  const auto plan_once = [&] {
    const ConfigurationSpace space(params_of(0.0), grid, {});
    tiles.grow(space.passable(), goals);
    return tiles.follow_gradient(start_of(office));
  };
  std::vector<std::size_t> path;
  for (const Cell& cell : plan_once()) {
    path.push_back(grid.geometry.index(cell));
  }
  const std::uint32_t cost = octile_cost(path, office.side);
  require(path.size() > 1 && cost >= office.octile && cost <= office.octile * 101 / 100, "cost of the path within 1 %");
  // cells that hang on by a corner may be missed, and no more
  require(tiles.reached() <= office.reached && tiles.reached() >= office.reached - office.reached / 100'000 - 1,
          "reached cells");
  for (auto _ : state) {
    benchmark::DoNotOptimize(plan_once());
  }
  state.counters["longer_percent"] = 100.0 * cost / office.octile - 100.0;
}

/// The same with the prices of the default mode, which keep the robot away from walls.
void plan_clearance(benchmark::State& state) {
  const Office& office = office_of(static_cast<int>(state.range(0)));
  const OccupancyGrid grid = grid_of(office);
  const std::size_t start = grid.geometry.index(start_of(office));
  CostField field;
  for (auto _ : state) {
    const ConfigurationSpace space(params_of(ConfigurationSpaceParams{}.clearance_weight), grid, {});
    grow_cost_field(space.terrain(), {{goal_of(office), 0}}, {}, field);
    benchmark::DoNotOptimize(follow_gradient(space.terrain(), field, start));
  }
}

/// A route as the planner gives it when somebody puts a box 3 m ahead of the robot, or takes it away.
void replan(benchmark::State& state) {
  const Office& office = office_of(static_cast<int>(state.range(0)));
  OccupancyGrid grid = grid_of(office);
  RoutePlannerParams params;
  params.space = params_of(ConfigurationSpaceParams{}.clearance_weight);
  RoutePlanner planner(params);
  planner.set_grid(grid, {});
  const RouteRequest request{grid.geometry.centre_of(start_of(office)), grid.geometry.centre_of(goal_of(office)), 0.2};
  const Route first = planner.plan(request);
  require(first.outcome == RouteOutcome::kFound, "a route");
  // the robot is half way
  const std::size_t half = first.points.size() / 2;
  const RouteRequest on_the_way{first.points[half], request.goal, request.tolerance};
  const Cell box = grid.geometry.cell_at(first.points[half + 15]);
  const auto put = [&](std::int8_t evidence) {
    for (int row = box.row - 2; row <= box.row + 2; ++row) {
      for (int column = box.column - 2; column <= box.column + 2; ++column) {
        grid.evidence[grid.geometry.index({column, row})] = evidence;
      }
    }
  };
  require(planner.plan(on_the_way).outcome == RouteOutcome::kFound, "a route from half way");
  std::int8_t evidence = 0;
  for (auto _ : state) {
    evidence = static_cast<std::int8_t>(50 - evidence);
    put(evidence);
    planner.set_grid(grid, {});
    benchmark::DoNotOptimize(planner.plan(on_the_way));
  }
  RoutePlanner anew(params);
  anew.set_grid(grid, {});
  const Route route = planner.plan(on_the_way);
  require(std::abs(route.cost - anew.plan(on_the_way).cost) < 1e-9, "cost of the route planned anew");
}

/// What `replan` is to be compared with: the same route with nothing kept.
void route(benchmark::State& state) {
  const Office& office = office_of(static_cast<int>(state.range(0)));
  const OccupancyGrid grid = grid_of(office);
  RoutePlannerParams params;
  params.space = params_of(ConfigurationSpaceParams{}.clearance_weight);
  const RouteRequest request{grid.geometry.centre_of(start_of(office)), grid.geometry.centre_of(goal_of(office)), 0.2};
  for (auto _ : state) {
    RoutePlanner planner(params);
    planner.set_grid(grid, {});
    benchmark::DoNotOptimize(planner.plan(request));
  }
}

BENCHMARK(cspace)->Arg(200)->Arg(1000)->Arg(4000)->Arg(4001);
BENCHMARK(cspace_opencv)->Arg(200)->Arg(1000)->Arg(4000)->Arg(4001);
BENCHMARK(plan)->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(plan_clearance)->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(route)->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(replan)->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
