// Particle filter and Kalman filter of the localizer on fixed workloads. Numbers come from a generator of their own, so
// that others can replicate them; known values of the workload and the filters' accuracy are checked before anything
// is timed, and the program fails if they are not met.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "services/localizer/model/pose_kalman.hpp"
#include "services/localizer/paper/particle_filter.hpp"

namespace luminav {
namespace {

constexpr double kStep = 0.05;  // [m]

struct Workload {
  Building building;
  std::vector<Pose2> truth;      // after each step; the first is the start
  std::vector<Pose2> odometry;   // odom_from_robot likewise
  std::vector<Pose2> increment;  // odometry of each step; the first is unused
  std::vector<std::vector<FixtureSighting>> sightings;
};

/// Lights in a grid of 3.0 x 2.4 m with some jitter, every other turned; a robot on a circle round their middle.
Workload make_workload(int columns, int rows, int steps, std::size_t sightings) {
  Workload work;
  SplitMix map_random(42);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      Fixture fixture;
      fixture.id = static_cast<int>(work.building.fixtures.size()) + 1;
      fixture.world_from_fixture.x = (i + 0.5) * 3.0 - 0.1 + 0.2 * map_random.uniform();
      fixture.world_from_fixture.y = (j + 0.5) * 2.4 - 0.1 + 0.2 * map_random.uniform();
      fixture.world_from_fixture.theta = (i + j) % 2 == 1 ? 0.5 * kPi : 0.0;
      work.building.fixtures.push_back(fixture);
    }
  }
  const double width = 3.0 * columns;
  const double height = 2.4 * rows;
  const double radius = std::min(width, height) / 2.0 - 1.5;
  const auto on_circle = [&](int step) {
    const double angle = kStep * step / radius;
    return Pose2{width / 2.0 + radius * std::cos(angle), height / 2.0 + radius * std::sin(angle),
                 wrap_angle(angle + 0.5 * kPi)};
  };
  SplitMix random(7);
  work.truth.push_back(on_circle(0));
  work.odometry.push_back({});
  work.increment.push_back({});
  work.sightings.emplace_back();
  for (int step = 1; step <= steps; ++step) {
    const Pose2 truth = on_circle(step);
    const double driven = distance(truth, work.truth[work.truth.size() - 1]) * (1.0 + 0.02 * random.gauss());
    const double turn = kStep / radius + 0.005 * random.gauss();
    const Pose2 increment{driven * std::cos(0.5 * turn), driven * std::sin(0.5 * turn), turn};
    work.truth.push_back(truth);
    work.increment.push_back(increment);
    work.odometry.push_back(work.odometry.back() * increment);
    std::vector<const Fixture*> nearest;
    for (const Fixture& fixture : work.building.fixtures) {
      nearest.push_back(&fixture);
    }
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(sightings), nearest.end(),
                      [&](const Fixture* a, const Fixture* b) {
                        return distance(a->world_from_fixture, truth) < distance(b->world_from_fixture, truth);
                      });
    std::vector<FixtureSighting> seen;
    for (std::size_t i = 0; i < sightings; ++i) {
      FixtureSighting sighting;
      sighting.robot_from_fixture = truth.inverse() * nearest[i]->world_from_fixture;
      sighting.robot_from_fixture.x += 0.05 * random.gauss();
      sighting.robot_from_fixture.y += 0.05 * random.gauss();
      sighting.robot_from_fixture.theta += 0.03 * random.gauss();
      sighting.covariance = Eigen::Vector3d(0.0025, 0.0025, 0.0009).asDiagonal();
      seen.push_back(sighting);
    }
    work.sightings.push_back(seen);
  }
  return work;
}

Workload make_workload(std::int64_t lights, int steps, std::size_t sightings) {
  return lights == 40    ? make_workload(8, 5, steps, sightings)
         : lights == 400 ? make_workload(25, 16, steps, sightings)
                         : make_workload(80, 50, steps, sightings);
}

ParticleParams particle_params(std::int64_t count) {
  ParticleParams params;
  params.count = static_cast<int>(count);
  params.scoring = ParticleScoring::kGaussian;
  params.resampling = ParticleResampling::kSystematic;
  params.heading_sigma = 0.1;
  params.random_share = 0.0;
  return params;
}

ParticleFilter start_filter(const FixtureMap& map, const WallField& walls, const ParticleParams& params,
                            const Workload& work) {
  ParticleFilter filter(map, walls, params, 1);
  filter.gather({work.truth.front(), Eigen::Vector3d(0.09, 0.09, 0.01).asDiagonal()}, 1.0);
  return filter;
}

/// Mean of the particles, which resampling left with one weight.
Pose2 mean_of(const ParticleFilter& filter) {
  const Pose2 reference = filter.pose(0);
  Pose2 sum;
  for (std::size_t i = 0; i < filter.size(); ++i) {
    const Pose2 pose = filter.pose(i);
    sum.x += pose.x;
    sum.y += pose.y;
    sum.theta += wrap_angle(pose.theta - reference.theta);
  }
  const double scale = 1.0 / static_cast<double>(filter.size());
  return {scale * sum.x, scale * sum.y, wrap_angle(reference.theta + scale * sum.theta)};
}

/// One iteration, its estimate included.
Pose2 run(ParticleFilter& filter, const Workload& work, std::size_t step) {
  filter.predict(work.increment[step]);
  filter.update(work.sightings[step]);
  return mean_of(filter);
}

/// RMSE [m] of the mean over the last three quarters.
double rmse(std::int64_t particles, std::int64_t lights, std::size_t sightings, int steps) {
  const Workload work = make_workload(lights, steps, sightings);
  const FixtureMap map(work.building.fixtures);
  const WallField walls;
  ParticleFilter filter = start_filter(map, walls, particle_params(particles), work);
  double sum = 0.0;
  int count = 0;
  for (std::size_t step = 1; step < work.truth.size(); ++step) {
    const Pose2 mean = run(filter, work, step);
    if (4 * step > work.truth.size()) {
      sum += std::pow(distance(mean, work.truth[step]), 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

int steps_for(std::int64_t particles) {
  return particles >= 100'000 ? 40 : 200;
}

void particle_filter(benchmark::State& state, const ParticleParams& params, std::int64_t lights, std::size_t sightings,
                     bool scattered) {
  const Workload work = make_workload(lights, steps_for(params.count), sightings);
  const FixtureMap map(work.building.fixtures);
  const WallField walls;
  ParticleFilter filter = start_filter(map, walls, params, work);
  const std::size_t steps = work.truth.size() - 1;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(steps))) {  // one iteration is one update
    state.PauseTiming();
    if (scattered) {
      filter.scatter();
    } else {
      filter.gather({work.truth.front(), Eigen::Vector3d(0.09, 0.09, 0.01).asDiagonal()}, 1.0);
    }
    state.ResumeTiming();
    for (std::size_t step = 1; step <= steps; ++step) {
      benchmark::DoNotOptimize(run(filter, work, step));
    }
  }
  state.counters["per_particle"] = benchmark::Counter(
      static_cast<double>(params.count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["bytes_per_particle"] =
      static_cast<double>(filter.memory_bytes()) / static_cast<double>(filter.size());
}

struct PoseWorkload {
  Pose2 start;
  std::vector<Pose2> increment;
  std::vector<Pose2> measured;
  std::vector<Pose2> truth;
};

PoseWorkload make_pose_workload() {
  const Workload work = make_workload(40, 2000, 1);
  SplitMix random(11);
  PoseWorkload poses{work.truth.front(), work.increment, {{}}, work.truth};
  for (std::size_t step = 1; step < work.truth.size(); ++step) {
    Pose2 pose = work.truth[step];
    pose.x += 0.05 * random.gauss();
    pose.y += 0.05 * random.gauss();
    pose.theta = wrap_angle(pose.theta + 0.03 * random.gauss());
    poses.measured.push_back(pose);
  }
  return poses;
}

/// Noise of an odometry step as the workload draws it: 2 % of the way and 0.005 rad of the turn, half of which acts on
/// the direction of the way.
Eigen::Matrix3d step_noise(const Pose2& increment) {
  const double distance = 0.02 * 0.02 * (increment.x * increment.x + increment.y * increment.y);
  const double turn = 0.005 * 0.005;
  const double x = -0.5 * increment.y;
  const double y = 0.5 * increment.x;
  Eigen::Matrix3d noise;
  noise << distance + turn * x * x, turn * x * y, turn * x,  //
      turn * x * y, turn * y * y, turn * y,                  //
      turn * x, turn * y, turn;
  return noise;
}

PoseBelief start_belief(const PoseWorkload& poses) {
  return {poses.start, Eigen::Vector3d(0.09, 0.09, 0.01).asDiagonal()};
}

void step_kalman(PoseBelief& belief, const Pose2& increment, const Pose2& measured) {
  const Eigen::Matrix3d noise = Eigen::Vector3d(0.0025, 0.0025, 0.0009).asDiagonal();
  predict(belief, increment, step_noise(increment));
  fuse_pose(belief,
            {measured.x - belief.pose.x, measured.y - belief.pose.y, wrap_angle(measured.theta - belief.pose.theta)},
            noise);
}

PoseBelief run_kalman(const PoseWorkload& poses) {
  PoseBelief belief = start_belief(poses);
  for (std::size_t step = 1; step < poses.increment.size(); ++step) {
    step_kalman(belief, poses.increment[step], poses.measured[step]);
  }
  return belief;
}

/// RMSE [m] over the last three quarters: the error of the last step alone is one draw of chance.
double kalman_rmse(const PoseWorkload& poses) {
  PoseBelief belief = start_belief(poses);
  double sum = 0.0;
  int count = 0;
  for (std::size_t step = 1; step < poses.increment.size(); ++step) {
    step_kalman(belief, poses.increment[step], poses.measured[step]);
    if (4 * step > poses.increment.size()) {
      sum += std::pow(distance(belief.pose, poses.truth[step]), 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

void kalman(benchmark::State& state) {
  const PoseWorkload poses = make_pose_workload();
  const auto steps = static_cast<benchmark::IterationCount>(poses.increment.size() - 1);
  while (state.KeepRunningBatch(steps)) {  // one iteration is one prediction and one correction
    benchmark::DoNotOptimize(run_kalman(poses));
  }
}

bool is_near(const char* what, double value, double expected, double tolerance) {
  if (std::abs(value - expected) <= tolerance) {
    return true;
  }
  fmt::print(stderr, "bench_localizer: {} is {:.12f}, must be {:.12f}\n", what, value, expected);
  return false;
}

bool is_at_most(const std::string& what, double value, double limit) {
  fmt::print("{}: {:.4f} m, at most {:.3f} m\n", what, value, limit);
  if (value <= limit) {
    return true;
  }
  fmt::print(stderr, "bench_localizer: {} is {:.4f} m, must be at most {:.4f} m\n", what, value, limit);
  return false;
}

bool check_workload() {
  const Workload work = make_workload(40, 200, 2);
  const Pose2& light = work.building.fixtures.front().world_from_fixture;
  const Pose2& end = work.odometry.back();
  bool good = is_near("first uniform number of seed 42", SplitMix(42).uniform(), 0.741564878772, 1e-12);
  good &= is_near("first normal number of seed 7", SplitMix(7).gauss(), 0.988474332319, 1e-12);
  good &= is_near("x of the first light", light.x, 1.548313, 1e-6);
  good &= is_near("y of the first light", light.y, 1.131982, 1e-6);
  good &= is_near("x of the odometry at step 200", end.x, 3.034184, 1e-6);
  good &= is_near("y of the odometry at step 200", end.y, 7.234379, 1e-6);
  good &= is_near("heading of the odometry at step 200", end.theta, 2.333749, 1e-6);
  return good;
}

constexpr std::array<double, 4> kGate = {0.0, 0.030, 0.018, 0.016};  // [m] by number of sightings

struct Case {
  std::int64_t particles;
  std::int64_t lights;
  std::size_t sightings;
};
constexpr std::array kCases = {Case{500, 40, 2},    Case{2000, 40, 1},   Case{2000, 40, 2},   Case{2000, 40, 3},
                               Case{2000, 400, 1},  Case{2000, 400, 3},  Case{2000, 4000, 3}, Case{10000, 40, 2},
                               Case{10000, 400, 3}, Case{100000, 40, 2}, Case{100000, 400, 3}};

bool check_accuracy() {
  bool good = true;
  for (const Case& c : kCases) {
    good &= is_at_most(fmt::format("error of pf/{}/{}/{}", c.particles, c.lights, c.sightings),
                       rmse(c.particles, c.lights, c.sightings, 200), kGate[c.sightings]);
  }
  const PoseWorkload poses = make_pose_workload();
  good &= is_at_most("error of kalman", kalman_rmse(poses), 0.012);
  return good;
}

void register_all() {
  for (const Case& c : kCases) {
    benchmark::RegisterBenchmark(fmt::format("pf/{}/{}/{}", c.particles, c.lights, c.sightings).c_str(),
                                 particle_filter, particle_params(c.particles), c.lights, c.sightings, false);
  }
  benchmark::RegisterBenchmark("pf_scattered/2000/400/3", particle_filter, particle_params(2000), 400, 3, true);
  ParticleParams paper;
  paper.count = 2000;
  benchmark::RegisterBenchmark("pf_paper/2000/40/2", particle_filter, paper, 40, 2, false);
  benchmark::RegisterBenchmark("kalman", kalman);
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  if (!luminav::check_workload() || !luminav::check_accuracy()) {
    return EXIT_FAILURE;
  }
  luminav::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return EXIT_FAILURE;
  }
  benchmark::RunSpecifiedBenchmarks();
  return EXIT_SUCCESS;
}
