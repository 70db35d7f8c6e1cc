// The search for the pose on a floor of 4,000 fixtures: the longest step, by thread time, and the heap that it takes.

#include <benchmark/benchmark.h>
#include <malloc.h>
#include <time.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "services/common/geometry/split_mix.hpp"
#include "services/localizer/modern_localizer.hpp"

namespace luminav {
namespace {

constexpr int kColumns = 80;
constexpr int kRows = 50;
constexpr int kSteps = 300;       // of 0.1 s
constexpr double kSpeed = 0.4;    // [m/s]
constexpr double kInView = 1.1;   // [m] of a fixture's centre
constexpr double kHeading = 0.4;  // [rad] that it drives along

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Fixtures every 3.0 m and 2.4 m with some jitter, every other turned: all poses stay possible for a while.
Building make_floor() {
  Building floor;
  floor.ceiling_height = 2.8;
  SplitMix random(42);
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      Fixture fixture;
      fixture.id = static_cast<int>(floor.fixtures.size()) + 1;
      fixture.world_from_fixture.x = (i + 0.5) * 3.0 - 0.1 + 0.2 * random.uniform();
      fixture.world_from_fixture.y = (j + 0.5) * 2.4 - 0.1 + 0.2 * random.uniform();
      fixture.world_from_fixture.theta = (i + j) % 2 == 1 ? 0.5 * kPi : 0.0;
      floor.fixtures.push_back(fixture);
    }
  }
  return floor;
}

SightingFrame look(const Building& floor, const Pose2& truth, std::int64_t utime) {
  SightingFrame frame;
  frame.utime = utime;
  for (const Fixture& fixture : floor.fixtures) {
    if (distance(fixture.world_from_fixture, truth) < kInView) {
      FixtureSighting sighting;
      sighting.robot_from_fixture = truth.inverse() * fixture.world_from_fixture;
      sighting.covariance = Eigen::Vector3d(1e-5, 1e-5, 1e-5).asDiagonal();
      sighting.length = fixture.length;
      sighting.width = fixture.width;
      sighting.state = SightingState::kLit;
      frame.sightings.push_back(sighting);
    }
  }
  return frame;
}

struct SearchCost {
  double worst_step = 0.0;  // [s]
  std::size_t poses = 0;    // most at a time
  std::size_t bytes = 0;    // of the heap, likewise
};

SearchCost search(const Building& floor) {
  RobotDescription robot;
  robot.camera.mounting.z = 0.3;
  ModernLocalizer localizer(floor, {}, robot, ErrorParams{}, ModernLocalizerParams{});
  const std::size_t before = mallinfo2().uordblks;
  SearchCost cost;
  for (int step = 0; step < kSteps; ++step) {
    const std::int64_t utime = 1'000'000'000 + 100'000LL * step;
    const double distance = 0.1 * kSpeed * step;
    const Pose2 truth = Pose2{100.0, 60.0, kHeading} * Pose2{distance, 0.0, 0.0};
    const SightingFrame frame = look(floor, truth, utime);
    const double begin = thread_seconds();
    localizer.add_frame(frame);
    localizer.add_odometry({utime, 1, {distance, 0.0, 0.0}, kSpeed, 0.0});
    cost.worst_step = std::max(cost.worst_step, thread_seconds() - begin);
    cost.poses = std::max(cost.poses, localizer.bank().hypotheses().size());
    cost.bytes = std::max(cost.bytes, mallinfo2().uordblks - before);
  }
  return cost;
}

void search_4000(benchmark::State& state) {
  const Building floor = make_floor();
  SearchCost cost;
  for (auto _ : state) {
    cost = search(floor);
    state.SetIterationTime(cost.worst_step);
  }
  state.counters["poses"] = static_cast<double>(cost.poses);
  state.counters["heap_MB"] = 1e-6 * static_cast<double>(cost.bytes);
}

BENCHMARK(search_4000)->Name("search/4000")->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
