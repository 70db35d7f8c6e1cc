#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/simulator/world/sonar_beam.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

// The real ring: 24 sonars of a SCITOS G5 that follows the walls of a room (tests/data/sonar_scitos_g5/README.md).
constexpr int kDiscs = 24;
constexpr double kRowTime = 1.0 / 9.0;  // [s]
constexpr int kRows = 5400;             // ten minutes

/// What one pulse of every disc heard [m].
using Row = std::vector<double>;

/// All as shares of a ring's readings, or of their changes from row to row.
struct RingFigures {
  double at_maximum = 0.0;
  double large_steps = 0.0;  // changes above 1 m
  double lone_losses = 0.0;  // no echo, where the same disc heard the same distance just before and just after
  double lone_echoes = 0.0;  // there, a distance more than 0.3 m shorter
};

RingFigures figures_of(const std::vector<Row>& rows, double maximum_range) {
  int at_maximum = 0;
  int large = 0;
  int steady = 0;
  int lost = 0;
  int shorter = 0;
  for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
    for (std::size_t disc = 0; disc < kDiscs; ++disc) {
      const double before = rows[i - 1][disc];
      const double now = rows[i][disc];
      const bool is_lost = now >= maximum_range - 0.01;
      at_maximum += is_lost ? 1 : 0;
      large += std::abs(now - before) > 1.0 ? 1 : 0;
      if (before < 4.0 && std::abs(rows[i + 1][disc] - before) < 0.05) {
        ++steady;
        lost += is_lost ? 1 : 0;
        shorter += now < before - 0.3 ? 1 : 0;
      }
    }
  }
  const double readings = static_cast<double>((rows.size() - 2) * kDiscs);
  const double pairs = std::max(1, steady);
  return {at_maximum / readings, large / readings, lost / pairs, shorter / pairs};
}

/// A room of 5.5 m by 4.5 m with cupboards along its walls and a table in its middle.
WorldTruth furnished_room() {
  WorldTruth truth = exact_truth(map_from_text(hall(11, 9)), {1.3, 1.6, 0.5 * kPi});
  truth.robot.footprint.clear();
  for (int i = 0; i < 12; ++i) {
    truth.robot.footprint.emplace_back(0.3 * std::cos(i * kPi / 6.0), 0.3 * std::sin(i * kPi / 6.0));
  }
  SonarRing& ring = truth.robot.sonar;
  ring.robot_from_sonar.clear();
  for (int disc = 0; disc < kDiscs; ++disc) {
    const double angle = wrap_angle(disc * 2.0 * kPi / kDiscs);
    ring.robot_from_sonar.push_back({0.25 * std::cos(angle), 0.25 * std::sin(angle), angle});
  }
  truth.obstacles = {
      {Pose2{2.2, 4.75, 0.0}, 1.6, 0.5, ObstacleKind::kBox}, {Pose2{5.75, 2.9, 0.0}, 0.5, 1.2, ObstacleKind::kBox},
      {Pose2{3.3, 0.75, 0.0}, 1.0, 0.5, ObstacleKind::kBox}, {Pose2{3.3, 2.8, 0.1}, 1.2, 0.7, ObstacleKind::kTable},
      {Pose2{0.7, 2.6, 0.0}, 0.4, 0.5, ObstacleKind::kBox},
  };
  return truth;
}

double nearest(const Row& row, double from, double to) {
  double min = 10.0;
  for (int disc = 0; disc < kDiscs; ++disc) {
    const double angle = wrap_angle(disc * 2.0 * kPi / kDiscs);
    if (angle >= from && angle <= to) {
      min = std::min(min, row[static_cast<std::size_t>(disc)]);
    }
  }
  return min;
}

/// Keeps the wall on its left by what the ring hears, as the real robot did: clockwise round the room.
std::vector<Row> follow_walls(const WorldTruth& truth, std::uint64_t seed, int rows) {
  const Scene scene(truth);
  SonarBeam sonar(truth.robot.sonar, seed);
  Pose2 robot = truth.start;
  std::vector<Row> heard;
  for (int i = 0; i < rows; ++i) {
    Row row;
    for (int disc = 0; disc < kDiscs; ++disc) {
      row.push_back(sonar.measure(scene, robot, disc));
    }
    const double ahead = nearest(row, radians(-31.0), radians(31.0));
    const double beside = nearest(row, radians(44.0), radians(136.0));
    const bool is_corner = ahead < 0.7;
    const double speed = is_corner ? 0.0 : 0.15;
    const double rate = is_corner ? -0.5 : std::clamp(1.5 * (beside - 0.5), -0.4, 0.25);
    robot = robot * Pose2{speed * kRowTime, 0.0, rate * kRowTime};
    heard.push_back(std::move(row));
  }
  return heard;
}

// The real one: 14.6 % at maximum, 6.1 % large steps, 0.9 % lone losses, 0.7 % lone short echoes.
TEST(SonarRing, LosesAndThrowsAsManyEchoesAsARealOneInAFurnishedRoom) {
  const WorldTruth truth = furnished_room();
  for (const std::uint64_t seed : {1000, 1001}) {
    const RingFigures figures = figures_of(follow_walls(truth, seed, kRows), truth.robot.sonar.maximum_range);
    fmt::print(
        "seed {}: {:.1f} % at maximum, {:.1f} % of the steps above 1 m, {:.2f} % lone losses, {:.2f} % lone short "
        "echoes\n",
        seed, 100.0 * figures.at_maximum, 100.0 * figures.large_steps, 100.0 * figures.lone_losses,
        100.0 * figures.lone_echoes);
    EXPECT_GE(figures.at_maximum, 0.09) << seed;
    EXPECT_LE(figures.at_maximum, 0.20) << seed;
    EXPECT_GE(figures.large_steps, 0.04) << seed;
    EXPECT_LE(figures.large_steps, 0.09) << seed;
    EXPECT_GE(figures.lone_losses, 0.006) << seed;
    EXPECT_LE(figures.lone_losses, 0.014) << seed;
    EXPECT_GE(figures.lone_echoes, 0.004) << seed;
    EXPECT_LE(figures.lone_echoes, 0.014) << seed;
  }
}

}  // namespace
}  // namespace luminav
