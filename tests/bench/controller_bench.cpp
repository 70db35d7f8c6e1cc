#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "services/controller/controller.hpp"
#include "services/controller/following/virtual_forces.hpp"
#include "tests/unit/controller/test_robot.hpp"

// A robot in a corridor of 2.4 m with doors and a box beside the way, and the grid around it, 0.1 m a cell.

namespace luminav {
namespace {

OccupancyGrid corridor() {
  OccupancyGrid grid({0.1, {0.0, 0.0}, 200, 200});
  for (int row = 0; row < 200; ++row) {
    for (int column = 0; column < 200; ++column) {
      const bool is_wall = (row >= 86 && row < 88) || (row >= 112 && row < 114);
      const bool is_door = column % 40 < 9;
      const bool is_box = row >= 88 && row < 93 && column >= 110 && column < 116;
      grid.prior[grid.geometry.index({column, row})] =
          (is_wall && !is_door) || is_box ? Prior::kOccupied : Prior::kFree;
    }
  }
  return grid;
}

/// Walls of the window, as the controller takes them from the grid; `radius` in cells of 0.1 m, 30 = 61 x 61 cells.
void walls_around(benchmark::State& state, int radius) {
  const OccupancyGrid grid = corridor();
  const double reach = 0.1 * radius;
  const Pose2 robot{10.05, 9.95, 0.1};
  if (known_walls(grid, robot, reach).empty()) {
    throw std::runtime_error("not the agreed workload: no walls");
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(known_walls(grid, robot, reach));
  }
}

void forces(benchmark::State& state) {
  const OccupancyGrid grid = corridor();
  const std::vector<Eigen::Vector2d> walls = known_walls(grid, {10.05, 9.95, 0.1}, 3.0);
  Obstacles obstacles{Footprint(testing::test_robot().footprint)};
  for (auto _ : state) {
    obstacles.set({}, walls);
    benchmark::DoNotOptimize(virtual_force({2.0, 0.3}, obstacles, {}));
  }
  state.counters["obstacles"] = static_cast<double>(walls.size());
}

/// The whole step on a path: walls, look-ahead, forces, free heading, speed, ramp, stop logic.
/// `radius` of the window in cells of 0.1 m.
void control(benchmark::State& state, int radius) {
  const OccupancyGrid grid = corridor();
  ControllerConfig config = ControllerConfig::for_robot(testing::test_robot());
  config.local_map.radius = 0.1 * radius;
  Controller controller(config);
  FollowedPath path;
  path.sequence = 1;
  for (int i = 0; i < 40; ++i) {
    path.points.emplace_back(10.0 + 0.2 * i, 10.0);
  }
  controller.set_path(path);
  ControlInput input;
  input.task = ControlTask::kFollow;
  input.world_from_robot = Pose2{10.05, 9.95, 0.1};
  input.grid = &grid;
  for (int beam = 0; beam < 16; ++beam) {
    const double angle = radians(22.5 * beam);
    input.echoes.push_back({{1.3 * std::cos(angle), 1.3 * std::sin(angle)}, 0.0, 0.1, false});
  }
  input.ages = {.odometry = 0.02, .sonar = 0.05, .front_sonar = 0.2, .rear_sonar = 0.2};
  double fastest = 0.0;
  for (auto _ : state) {
    input.now += 50'000;
    ControlOutput output = controller.step(input);
    fastest = std::max(fastest, output.twist.linear);
    benchmark::DoNotOptimize(output.twist);
  }
  if (!(fastest > 0.0)) {
    throw std::runtime_error("not the agreed workload: it does not drive");
  }
}

BENCHMARK_CAPTURE(walls_around, window_61x61, 30)->Name("walls_around");
BENCHMARK_CAPTURE(walls_around, window_31x31, 15)->Name("walls_around/31x31");
BENCHMARK(forces);
BENCHMARK_CAPTURE(control, window_61x61, 30)->Name("control");
BENCHMARK_CAPTURE(control, window_31x31, 15)->Name("control/31x31");

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
