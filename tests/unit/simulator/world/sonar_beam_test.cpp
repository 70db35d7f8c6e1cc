#include "drivers/simulator/world/sonar_beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

constexpr int kPulses = 4000;

struct Readings {
  double mean = 0.0;       // [m] of those near the expected distance
  double deviation = 0.0;  // [m]
  double near = 0.0;       // share within 10 cm of the expected distance
  double none = 0.0;       // share without an echo
  double longer = 0.0;     // share of echoes more than 10 cm too long
};

Readings measure(const WorldTruth& truth, const Pose2& pose, double expected, const SonarParams& params = {}) {
  const Scene scene(truth);
  SonarBeam sonar(truth.robot.sonar, 5, params);
  Readings result;
  std::vector<double> near;
  for (int i = 0; i < kPulses; ++i) {
    const double range = sonar.measure(scene, pose, 0);
    EXPECT_GE(range, truth.robot.sonar.minimum_range);
    EXPECT_LE(range, truth.robot.sonar.maximum_range);
    if (range >= truth.robot.sonar.maximum_range) {
      result.none += 1.0 / kPulses;
    } else if (std::abs(range - expected) < 0.1) {
      near.push_back(range);
      result.near += 1.0 / kPulses;
    } else if (range > expected) {
      result.longer += 1.0 / kPulses;
    }
  }
  for (const double range : near) {
    result.mean += range / static_cast<double>(near.size());
  }
  for (const double range : near) {
    result.deviation += std::pow(range - result.mean, 2) / static_cast<double>(near.size());
  }
  result.deviation = std::sqrt(result.deviation);
  return result;
}

/// Free from 0.5 to 12.5 and from 0.5 to 10.5.
WorldTruth wide_hall() {
  return exact_truth(map_from_text(hall(24, 20)), {});
}

TEST(SonarBeam, MeasuresAWallSquareOnWithLittleNoise) {
  for (const double range : {0.5, 2.0, 4.0}) {
    const Readings readings = measure(wide_hall(), {12.5 - range, 5.5, 0.0}, range);
    EXPECT_GT(readings.near, 0.95);
    EXPECT_NEAR(readings.mean, range, 0.005);
    EXPECT_GT(readings.deviation, 0.003);  // 0.3 cm near
    EXPECT_LT(readings.deviation, 0.011);  // 1 cm at the end of its range
  }
}

TEST(SonarBeam, SaysTheMaximumWhenNothingIsThere) {
  const Readings readings = measure(wide_hall(), {6.0, 5.5, 0.0}, 5.0);
  EXPECT_GT(readings.none, 0.99);
}

TEST(SonarBeam, SaysTheMinimumToWhatIsNearer) {
  WorldTruth truth = wide_hall();
  const Scene scene(truth);
  SonarParams params;
  params.dropout = params.crosstalk = 0.0;
  SonarBeam sonar(truth.robot.sonar, 5, params);
  EXPECT_NEAR(sonar.measure(scene, {12.45, 5.5, 0.0}, 0), truth.robot.sonar.minimum_range, 0.02);
}

TEST(SonarBeam, LosesASmoothWallBeyondTwentyFiveDegrees) {
  // 2 m before the east wall, turned away from square on
  const auto at = [](double turned) { return measure(wide_hall(), {10.5, 5.5, radians(turned)}, 2.0); };
  EXPECT_GT(at(10.0).near, 0.9);
  EXPECT_LT(at(45.0).near, 0.02);
  double previous = 1.0;
  for (const double turned : {15.0, 20.0, 25.0, 30.0, 35.0}) {
    const double near = at(turned).near;
    EXPECT_LE(near, previous + 0.03) << turned;
    previous = near;
  }
  EXPECT_LT(previous, 0.1);
}

TEST(SonarBeam, ReadsTooFarWhenAWallIsAMirror) {
  // 45 degrees to the east wall, which shows a person outside of the cone
  WorldTruth truth = wide_hall();
  truth.people = {{{{11.79, 9.71}, {11.79, 9.71}}, 0.0}};
  const Readings readings = measure(truth, {11.5, 8.0, radians(45.0)}, std::sqrt(2.0));
  EXPECT_LT(readings.near, 0.05);
  EXPECT_GT(readings.longer, 0.9);
  EXPECT_GT(measure(wide_hall(), {11.5, 8.0, radians(45.0)}, std::sqrt(2.0)).none, 0.9);
}

TEST(SonarBeam, HearsThingsInItsConeOnly) {
  WorldTruth truth = wide_hall();
  const auto person_at = [](double degrees_off) {
    const Eigen::Vector2d point(5.0 + 2.0 * std::cos(radians(degrees_off)), 5.5 + 2.0 * std::sin(radians(degrees_off)));
    return WalkingPerson{{point, point}, 0.0};
  };
  truth.people = {person_at(0.0)};
  EXPECT_GT(measure(truth, {5.0, 5.5, 0.0}, 1.75).near, 0.9);
  truth.people = {person_at(40.0)};
  EXPECT_LT(measure(truth, {5.0, 5.5, 0.0}, 1.75).near, 0.01);
}

TEST(SonarBeam, HearsABoxAlsoByItsCornerButNotFar) {
  WorldTruth truth = wide_hall();
  truth.obstacles = {{Pose2{6.0, 5.5, 0.25 * kPi}, 0.4, 0.4, ObstacleKind::kBox}};
  const double half_diagonal = 0.2 * std::sqrt(2.0);
  EXPECT_GT(measure(truth, {5.0, 5.5, 0.0}, 1.0 - half_diagonal).near, 0.9);
  EXPECT_LT(measure(truth, {2.0, 5.5, 0.0}, 4.0 - half_diagonal).near, 0.25);
}

TEST(SonarBeam, HardlySeesLegsTablesAndGlass) {
  for (const ObstacleKind kind : {ObstacleKind::kLegs, ObstacleKind::kTable}) {
    WorldTruth truth = wide_hall();
    truth.obstacles = {{Pose2{5.8, 5.5, 0.0}, 0.5, 0.02, kind}};
    const double near = measure(truth, {5.0, 5.5, 0.0}, 0.55).near;
    EXPECT_LT(near, 0.6);
    EXPECT_GT(near, 0.05);
  }
  WorldTruth truth = wide_hall();
  truth.obstacles = {{Pose2{6.0, 5.5, 0.5 * kPi}, 2.0, 0.02, ObstacleKind::kGlass}};
  EXPECT_GT(measure(truth, {5.0, 5.5, 0.0}, 0.99).near, 0.9);  // square on it is a mirror that shows the disc itself
  EXPECT_LT(measure(truth, {5.0, 5.5, radians(28.0)}, 0.99).near, 0.05);
}

TEST(SonarBeam, DropsEchoesAndHearsOthersNowAndThen) {
  const SonarParams params{.dropout = 0.05, .crosstalk = 0.03};
  const Readings readings = measure(wide_hall(), {8.5, 5.5, 0.0}, 4.0, params);
  EXPECT_NEAR(readings.none, 0.05, 0.01);
  EXPECT_NEAR(1.0 - readings.none - readings.near - readings.longer, 0.03, 0.01);
}

TEST(SonarBeam, IsTheSameForTheSameSeed) {
  const WorldTruth truth = wide_hall();
  const Scene scene(truth);
  SonarBeam first(truth.robot.sonar, 9);
  SonarBeam second(truth.robot.sonar, 9);
  SonarBeam third(truth.robot.sonar, 10);
  int same = 0;
  for (int i = 0; i < 200; ++i) {
    const double range = first.measure(scene, {10.0, 5.5, 0.1 * i}, i % 2);
    EXPECT_EQ(range, second.measure(scene, {10.0, 5.5, 0.1 * i}, i % 2));
    same += range == third.measure(scene, {10.0, 5.5, 0.1 * i}, i % 2) && range < 5.0 ? 1 : 0;
  }
  EXPECT_LT(same, 5);
}

}  // namespace
}  // namespace luminav
