// MRPT on the same work, for the ratio in the same run. Built where libmrpt-slam-dev and libmrpt-nav-dev are installed.
#include <benchmark/benchmark.h>
#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/maps/CBeaconMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/nav/holonomic/CHolonomicVFF.h>
#include <mrpt/nav/planners/PlannerSimple2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationBeaconRanges.h>
#include <mrpt/obs/CObservationRange.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/random.h>
#include <mrpt/slam/CMonteCarloLocalization2D.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "tests/unit/planner/office_grid.hpp"

namespace luminav {
namespace {

/// Own dilation, wavefront and path on the office floor; the length is what MRPT agreed to before.
void plan_mrpt(benchmark::State& state) {
  const auto side = static_cast<int>(state.range(0));
  const std::vector<std::uint8_t> cells = office_grid(side, 0.1);
  mrpt::maps::COccupancyGridMap2D grid(0.0F, 0.1F * static_cast<float>(side), 0.0F, 0.1F * static_cast<float>(side),
                                       0.1F);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      grid.setCell(
          x, y,
          cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x)] != 0
              ? 0.0F
              : 1.0F);
    }
  }
  mrpt::nav::PlannerSimple2D planner;
  planner.robotRadius = 0.25F;
  const double far = 0.1 * side - 1.0;
  std::deque<mrpt::math::TPoint2D> path;
  for (auto _ : state) {
    bool not_found = false;
    planner.computePath(grid, mrpt::poses::CPose2D(1.0, 1.0, 0.0), mrpt::poses::CPose2D(far, far, 0.0), path,
                        not_found);
    if (not_found) {
      throw std::runtime_error("MRPT found no path");
    }
  }
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += (path[i] - path[i - 1]).norm();
  }
  state.counters["length_m"] = length;
}

/// One observation per beam: with 16 beams in one, MRPT 2.5.8 draws all cones in the first one's direction.
void sonar_mrpt(benchmark::State& state) {
  mrpt::maps::COccupancyGridMap2D grid(-20.0F, 20.0F, -20.0F, 20.0F, 0.1F);
  mrpt::random::CRandomGenerator random(3);
  struct Scan {
    mrpt::poses::CPose3D robot;
    std::vector<mrpt::obs::CObservationRange> beams;
  };
  std::vector<Scan> scans(500);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const double along = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(scans.size());
    scans[i].robot = mrpt::poses::CPose3D(10.0 * std::cos(along), 10.0 * std::sin(along), 0.0,
                                          along + 0.5 * std::numbers::pi, 0.0, 0.0);
    for (int beam = 0; beam < 16; ++beam) {
      const double angle = radians(22.5 * beam);
      mrpt::obs::CObservationRange observation;
      observation.maxSensorDistance = 5.0F;
      observation.sensorConeApperture = static_cast<float>(radians(20.0));
      mrpt::obs::CObservationRange::TMeasurement measurement;
      measurement.sensorPose =
          mrpt::math::TPose3D(0.25 * std::cos(angle), 0.25 * std::sin(angle), 0.0, angle, 0.0, 0.0);
      measurement.sensedDistance =
          static_cast<float>(random.drawUniform(0.0, 1.0) < 0.25 ? 5.0 : random.drawUniform(0.5, 5.0));
      observation.sensedData.push_back(measurement);
      scans[i].beams.push_back(observation);
    }
  }
  std::size_t next = 0;
  for (auto _ : state) {
    for (const auto& beam : scans[next].beams) {
      grid.insertObservation(beam, scans[next].robot);
    }
    next = (next + 1) % scans.size();
  }
}

/// Virtual force field over 361 directions, as a laser's.
void control_mrpt(benchmark::State& state) {
  mrpt::nav::CHolonomicVFF field;
  mrpt::nav::CAbstractHolonomicReactiveMethod::NavInput input;
  mrpt::random::CRandomGenerator random(5);
  for (int i = 0; i < 361; ++i) {
    input.obstacles.push_back(random.drawUniform(0.2, 1.0));
  }
  input.targets.emplace_back(0.8, 0.3);
  mrpt::nav::CAbstractHolonomicReactiveMethod::NavOutput output;
  for (auto _ : state) {
    field.navigate(input, output);
    benchmark::DoNotOptimize(output.desiredDirection);
  }
}

/// Monte Carlo localization by ranges to known lights: no orientation of the lights, and no question which one is seen.
void pf_mrpt(benchmark::State& state) {
  const auto particles = static_cast<std::size_t>(state.range(0));
  const int columns = state.range(1) == 40 ? 8 : 25;
  const int rows = state.range(1) == 40 ? 5 : 16;
  const auto sightings = static_cast<std::size_t>(state.range(2));
  mrpt::random::getRandomGenerator().randomize(7);
  auto map = mrpt::maps::CBeaconMap::Create();
  std::vector<Eigen::Vector2d> lights;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      lights.emplace_back((i + 0.5) * 3.0, (j + 0.5) * 2.4);
      mrpt::maps::CBeacon beacon;
      beacon.m_ID = static_cast<std::int64_t>(lights.size());
      beacon.m_typePDF = mrpt::maps::CBeacon::pdfGauss;
      beacon.m_locationGauss.mean = mrpt::poses::CPoint3D(lights.back().x(), lights.back().y(), 2.0);
      beacon.m_locationGauss.cov.setDiagonal(3, 1e-4);
      map->push_back(beacon);
    }
  }
  map->likelihoodOptions.rangeStd = 0.1F;
  const double width = 3.0 * columns;
  const double height = 2.4 * rows;
  const double radius = 0.5 * std::min(width, height) - 1.5;
  const auto truth_at = [&](int step) {
    const double angle = 0.05 * step / radius;
    return Pose2{0.5 * width + radius * std::cos(angle), 0.5 * height + radius * std::sin(angle),
                 wrap_angle(angle + 0.5 * std::numbers::pi)};
  };
  mrpt::slam::CMonteCarloLocalization2D filter(particles);
  filter.options.metricMap = map;
  const Pose2 start = truth_at(0);
  for (auto& particle : filter.m_particles) {
    auto& random = mrpt::random::getRandomGenerator();
    particle.d =
        mrpt::math::TPose2D(start.x + random.drawGaussian1D(0.0, 0.3), start.y + random.drawGaussian1D(0.0, 0.3),
                            start.theta + random.drawGaussian1D(0.0, 0.1));
    particle.log_w = 0.0;
  }
  mrpt::bayes::CParticleFilter executor;
  executor.m_options.PF_algorithm = mrpt::bayes::CParticleFilter::pfStandardProposal;
  executor.m_options.resamplingMethod = mrpt::bayes::CParticleFilter::prSystematic;
  executor.m_options.adaptiveSampleSize = false;
  executor.m_options.BETA = 1.0;  // resamples always
  int step = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Pose2 before = truth_at(step);
    const Pose2 truth = truth_at(++step);
    const Pose2 moved = before.inverse() * truth;
    mrpt::obs::CActionRobotMovement2D movement;
    mrpt::obs::CActionRobotMovement2D::TMotionModelOptions options;
    options.modelSelection = mrpt::obs::CActionRobotMovement2D::mmThrun;
    movement.computeFromOdometry(mrpt::poses::CPose2D(moved.x, moved.y, moved.theta), options);
    mrpt::obs::CActionCollection actions;
    actions.insert(movement);
    auto ranges = mrpt::obs::CObservationBeaconRanges::Create();
    std::vector<std::size_t> order(lights.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = i;
    }
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(sightings), order.end(),
                      [&](std::size_t a, std::size_t b) {
                        return (lights[a] - truth.position()).norm() < (lights[b] - truth.position()).norm();
                      });
    for (std::size_t i = 0; i < sightings; ++i) {
      mrpt::obs::CObservationBeaconRanges::TMeasurement measurement;
      measurement.beaconID = static_cast<std::int32_t>(order[i]) + 1;
      measurement.sensedDistance = static_cast<float>(std::hypot((lights[order[i]] - truth.position()).norm(), 2.0));
      ranges->sensedData.push_back(measurement);
    }
    mrpt::obs::CSensoryFrame frame;
    frame.insert(ranges);
    state.ResumeTiming();
    executor.executeOn(filter, &actions, &frame);
    benchmark::DoNotOptimize(filter.getMeanVal());
  }
  const auto mean = filter.getMeanVal();
  const Pose2 truth = truth_at(step);
  state.counters["error_m"] = std::hypot(mean.x() - truth.x, mean.y() - truth.y);
  state.counters["per_particle"] = benchmark::Counter(
      static_cast<double>(particles), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(pf_mrpt)->Args({2000, 40, 2})->Args({2000, 400, 3})->Iterations(200)->Unit(benchmark::kMicrosecond);
BENCHMARK(plan_mrpt)->Arg(200)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(sonar_mrpt)->Name("sonar_mrpt/cones");
BENCHMARK(control_mrpt);

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
