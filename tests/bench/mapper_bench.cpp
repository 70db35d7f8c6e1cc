#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/geometry/split_mix.hpp"
#include "services/mapper/grid_mapper.hpp"
#include "services/mapper/sonar/sonar_model.hpp"

// The sonar workload of the performance page: 400 x 400 cells of 0.1 m, 2000 scans of 16 beams from a circle of 10 m.

namespace luminav {
namespace {

constexpr int kScans = 2000;
constexpr int kBeams = 16;
constexpr double kMaximumRange = 5.0;  // [m]

std::vector<DiscReading> scans() {
  SplitMix draw(3);
  std::vector<DiscReading> readings;
  for (int scan = 0; scan < kScans; ++scan) {
    const double along = 2.0 * std::numbers::pi * scan / kScans;
    const Pose2 robot{10.0 * std::cos(along), 10.0 * std::sin(along), wrap_angle(along + 0.5 * std::numbers::pi)};
    for (int beam = 0; beam < kBeams; ++beam) {
      const double angle = wrap_angle(beam * radians(22.5));
      DiscReading reading;
      reading.disc = beam;
      reading.utime = 1'000'000 + 100'000 * static_cast<std::int64_t>(scan);
      reading.world_from_robot = robot;
      reading.world_from_sonar = robot * Pose2{0.25 * std::cos(angle), 0.25 * std::sin(angle), angle};
      reading.has_echo = draw.uniform() >= 0.25;
      reading.range = reading.has_echo ? 0.5 + (kMaximumRange - 0.5) * draw.uniform() : kMaximumRange;
      readings.push_back(reading);
    }
  }
  return readings;
}

PriorMap empty_map() {
  PriorMap map;
  map.geometry = {0.1, {-20.0, -20.0}, 400, 400};
  map.cells.assign(map.geometry.size(), Prior::kUnknown);
  return map;
}

/// Votes for every cell out to the reading, as the peers count them, 20 degrees wide.
SonarModelParams model_params(SonarModelKind kind) {
  SonarModelParams params;
  params.kind = kind;
  params.half_angle = radians(10.0);
  params.free_range = params.no_echo_range = params.occupied_range = kMaximumRange;
  params.maximum_range = kMaximumRange;
  params.free_margin = 0.0;
  params.core_log_odds = 0.0;
  return params;
}

/// The model alone: votes of one scan into the grid.
void sonar(benchmark::State& state, SonarModelKind kind, double min_cells, double max_cells) {
  std::vector<BeamReading> readings;
  for (const DiscReading& reading : scans()) {
    readings.push_back({reading.world_from_sonar, reading.range, reading.has_echo});
  }
  const SonarModelParams params = model_params(kind);
  FreeSpaceModel model(params);
  OccupancyGrid grid(empty_map().geometry);
  SliceRanges open;
  open.fill(kMaximumRange);
  const std::int8_t vote = to_evidence(params.occupied_log_odds);
  const auto scan = [&](std::size_t first) {
    for (std::size_t i = first; i < first + kBeams; ++i) {
      const BeamReading& beam = readings[i];
      model.apply(beam, open, grid);
      if (beam.has_echo) {
        for (const ArcCell& cell : cells_of_echo(params, grid.geometry, beam, 0.0)) {
          std::int8_t& evidence = grid.evidence[grid.geometry.index(cell.cell)];
          evidence = static_cast<std::int8_t>(std::min(50, evidence + vote));
        }
      }
    }
  };
  double cells = 0.0;  // touched by each of the first scans, on a clean grid
  for (std::size_t k = 0; k < 50; ++k) {
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      std::fill(grid.evidence.begin(), grid.evidence.end(), std::int8_t{10});
      model.apply(readings[(40 * k) * kBeams + beam], open, grid);
      cells += static_cast<double>(
          std::count_if(grid.evidence.begin(), grid.evidence.end(), [](auto v) { return v != 10; }));
    }
  }
  cells /= 50.0;
  if (cells < min_cells || cells > max_cells) {
    throw std::runtime_error("not the agreed workload: cells per scan " + std::to_string(cells));
  }
  std::size_t next = 0;
  for (auto _ : state) {
    scan(next);
    next = (next + kBeams) % readings.size();
  }
  state.counters["cells"] = cells;
}

/// All that the mapper does with a scan: confirmation, line of sight, votes, disputes.
void mapper_scan(benchmark::State& state, SonarModelKind kind) {
  const std::vector<DiscReading> readings = scans();
  GridMapperParams params;
  params.sonar.kind = kind;
  GridMapper mapper(params, empty_map(), kBeams);
  std::size_t next = 0;
  for (auto _ : state) {
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      mapper.integrate(readings[next + beam]);
    }
    next = (next + kBeams) % readings.size();
  }
}

BENCHMARK_CAPTURE(sonar, lines, SonarModelKind::kLine, 450.0, 560.0);
BENCHMARK_CAPTURE(sonar, cones, SonarModelKind::kCone, 3600.0, 4700.0);
BENCHMARK_CAPTURE(mapper_scan, lines, SonarModelKind::kLine);
BENCHMARK_CAPTURE(mapper_scan, cones, SonarModelKind::kCone);

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
