#include "services/localizer/modern_localizer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/localizer/trial.hpp"

namespace luminav {
namespace {

using testing::run_trial;
using testing::SyntheticOptions;
using testing::SyntheticWorld;
using testing::TestBuilding;
using testing::TrialPlan;
using testing::TrialResult;

RobotDescription robot() {
  RobotDescription robot;
  robot.camera.mounting.z = 0.3;
  for (int i = 0; i < 16; ++i) {
    const double angle = wrap_angle(2.0 * kPi * i / 16.0);
    robot.sonar.robot_from_sonar.push_back({0.2 * std::cos(angle), 0.2 * std::sin(angle), angle});
  }
  return robot;
}

TrialResult drive(const TestBuilding& building, const SyntheticOptions& options, const TrialPlan& plan,
                  const ModernLocalizerParams& params = {}) {
  SyntheticWorld world(building.building, building.walls, robot(), options);
  ModernLocalizer localizer(building.building, building.walls, robot(), ErrorParams{}, params);
  return run_trial(world, localizer, plan);
}

TEST(ModernLocalizer, FindsItselfFromUnknownStartsAndIsNeverConfidentlyWrong) {
  const TestBuilding building = testing::two_rooms();
  int localized = 0;
  double tracking = 0.0;
  double after = 0.0;
  for (std::uint64_t seed = 1000; seed < 1012; ++seed) {
    const TrialResult result = drive(building, {.seed = seed, .clutter = 0}, {.duration = 120.0});
    EXPECT_EQ(result.confident_wrong, 0.0) << "seed " << seed;
    EXPECT_EQ(result.localized, result.correct_first) << "seed " << seed;
    localized += result.localized ? 1 : 0;
    tracking += result.tracking;
    after += result.after_first;
  }
  EXPECT_GE(localized, 11);
  EXPECT_GT(tracking / after, 0.97);
}

TEST(ModernLocalizer, FindsItselfUnderRoundLampsAlone) {
  TestBuilding building = testing::two_rooms();
  for (Fixture& fixture : building.building.fixtures) {
    fixture.shape = FixtureShape::kRound;
    fixture.length = fixture.width = 0.3;
    fixture.world_from_fixture.theta = 0.0;
  }
  building.building.fixtures[1].world_from_fixture.y -= 0.7;  // no room maps onto itself
  int localized = 0;
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const TrialResult result = drive(building, {.seed = seed, .clutter = 0}, {.duration = 120.0});
    EXPECT_EQ(result.confident_wrong, 0.0) << "seed " << seed;
    localized += result.localized ? 1 : 0;
  }
  EXPECT_GE(localized, 5);
}

TEST(ModernLocalizer, NoticesThatItWasCarriedAndRecovers) {
  const TestBuilding building = testing::two_rooms();
  double recovered = 0.0;
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const TrialResult result = drive(building, {.seed = seed, .clutter = 0}, {.duration = 240.0, .kidnaps = {120.0}});
    EXPECT_EQ(result.confident_wrong, 0.0) << "seed " << seed;
    recovered += result.recovered;
  }
  EXPECT_GE(recovered, 5.0);
}

TEST(ModernLocalizer, MayAskForMoreOnceItsPoseWasInDoubt) {
  const TestBuilding building = testing::two_rooms();
  ModernLocalizerParams params;
  params.rules.enter_margin = 1000.0;
  const SyntheticOptions options{.seed = 1002, .clutter = 0};
  const TrialPlan plan{.duration = 240.0, .kidnaps = {120.0}};
  const TrialResult result = drive(building, options, plan, params);
  EXPECT_TRUE(result.localized);
  EXPECT_EQ(result.recovered, 0.0);
  params.rules.first_margin = 1000.0;
  EXPECT_FALSE(drive(building, options, plan, params).localized);
}

TEST(ModernLocalizer, StaysAmbiguousWhereBothEndsLookAlike) {
  const TestBuilding building = testing::symmetric_corridor(4, 3.0);
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const TrialResult result = drive(building, {.seed = seed, .clutter = 0, .unknown_boxes = 0}, {.duration = 120.0});
    EXPECT_FALSE(result.localized) << "seed " << seed;
  }
}

TEST(ModernLocalizer, ListsBothTrueAlternativesOfASymmetricCorridor) {
  const TestBuilding building = testing::symmetric_corridor(3, 3.0);
  SyntheticWorld world(building.building, building.walls, robot(), {.seed = 1001, .clutter = 0, .unknown_boxes = 0});
  ModernLocalizer localizer(building.building, building.walls, robot(), ErrorParams{}, ModernLocalizerParams{});
  run_trial(world, localizer, {.duration = 120.0});
  const auto poses = localizer.hypotheses(2);
  ASSERT_EQ(poses.size(), 2U);
  const Pose2 centre{4.5, 1.2, kPi};
  const Pose2 alias = centre * Pose2{-4.5, -1.2, 0.0} * world.truth();
  for (const Pose2& alternative : {world.truth(), alias}) {
    EXPECT_LT(std::min(distance(poses[0].pose, alternative), distance(poses[1].pose, alternative)), 0.25);
  }
}

TEST(ModernLocalizer, IsSureBySonarAloneUnlessItsRulesAskForMore) {
  // the ceiling looks the same from both ends, one half is narrower
  TestBuilding building = testing::symmetric_corridor(6, 3.0);
  const GridGeometry& geometry = building.walls.geometry;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const Eigen::Vector2d place = geometry.centre_of({column, row});
      if (place.x() < 9.0 && std::abs(place.y() - 1.2) > 0.8) {
        building.walls.cells[geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto is_sure = [&](const ModernLocalizerParams& params) {
      SyntheticWorld world(building.building, building.walls, robot(),
                           {.seed = seed, .perfect = true, .clutter = 0, .unknown_boxes = 0});
      ModernLocalizer localizer(building.building, building.walls, robot(), ErrorParams{}, params);
      localizer.recall({{-50.0, -50.0, 0.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()});
      const bool is_localized = run_trial(world, localizer, {.duration = 120.0}).localized;
      const auto poses = localizer.hypotheses(2);
      EXPECT_TRUE(is_localized || (poses.size() == 2 && poses[1].weight > 0.01)) << "the other end is to be looked at";
      EXPECT_TRUE(is_localized || localizer.estimate().reason.find("the sonars hear") != std::string::npos);
      return is_localized;
    };
    EXPECT_TRUE(is_sure({})) << "seed " << seed;
    ModernLocalizerParams params;
    params.rules.min_without_sonar = 2.0;
    EXPECT_FALSE(is_sure(params)) << "seed " << seed;
  }
}

TEST(ModernLocalizer, SaysThatABuildingWithoutFixturesCannotBeUsed) {
  ModernLocalizer localizer({}, {}, robot(), ErrorParams{}, ModernLocalizerParams{});
  localizer.add_odometry({1'000'000, 1, {}, 0.0, 0.0});
  localizer.add_frame({1'050'000, {}});
  localizer.add_odometry({1'100'000, 1, {}, 0.0, 0.0});
  EXPECT_EQ(localizer.estimate().state, LocalizerState::kLost);
  EXPECT_NE(localizer.estimate().reason.find("no fixtures"), std::string::npos);
}

/// A robot below lamps that hang all alike, every 2.4 m along x, which drives in that direction without
/// errors.
class RowOfLamps {
 public:
  static constexpr double kPitch = 2.4;  // [m]

  /// A building that lists as many of them from the one with that number on; below the first one x is 0.
  [[nodiscard]] static Building listed(int first, int count, bool is_complete) {
    Building building;
    building.ceiling_height = 2.8;
    building.is_complete = is_complete;
    building.fixtures.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      building.fixtures[static_cast<std::size_t>(i)].world_from_fixture = {kPitch * (first + i), 0.0, 0.0};
    }
    return building;
  }

  /// Goes on by 4 cm, and looks.
  void step(Localizer& localizer) {
    const std::int64_t utime = 1'000'000'000 + 100'000 * ++steps_;
    localizer.add_odometry({utime, 1, {x(), 0.0, 0.0}, 0.4, 0.0});
    SightingFrame frame{utime, {}};
    const double ahead = kPitch * std::round(x() / kPitch) - x();
    if (std::abs(ahead) < 0.6) {
      FixtureSighting& sighting = frame.sightings.emplace_back();
      sighting.robot_from_fixture = {ahead, 0.0, 0.0};
      sighting.covariance = Eigen::Vector3d(1e-5, 1e-5, 1e-5).asDiagonal();
      sighting.length = Fixture{}.length;
      sighting.width = Fixture{}.width;
      sighting.state = SightingState::kLit;
    }
    localizer.add_frame(frame);
  }
  [[nodiscard]] double x() const { return 0.04 * steps_; }

 private:
  int steps_ = 0;
};

// The file of a survey lists one of three lamps in a row: the search goes on below those that it does not list.
TEST(ModernLocalizer, KeepsItsPosesWhereTheFileNeedNotListWhatIsSeen) {
  for (const bool is_complete : {false, true}) {
    ModernLocalizer localizer(RowOfLamps::listed(0, 1, is_complete), PriorMap{}, robot(), ErrorParams{}, {});
    RowOfLamps row;
    bool began_anew = false;
    while (row.x() < 6.0) {
      row.step(localizer);
      began_anew = began_anew || localizer.estimate().reason.find("searching anew") != std::string::npos;
    }
    EXPECT_EQ(began_anew, is_complete);
  }
}

// A robot leaves the part of a corridor that a survey saw, or comes into it. That lamps go on as before beyond it
// speaks little against the right pose: else others, from which all of them are listed, would be held for true.
TEST(ModernLocalizer, KeepsTheRightPoseWhereARowGoesOnBeyondTheFile) {
  for (const int first : {-13, 12}) {
    ModernLocalizer localizer(RowOfLamps::listed(first, 14, false), PriorMap{}, robot(), ErrorParams{}, {});
    RowOfLamps row;
    while (row.x() < 13.5 * RowOfLamps::kPitch) {
      row.step(localizer);
    }
    const std::vector<WeightedPose> poses = localizer.hypotheses(500);
    EXPECT_TRUE(
        std::any_of(poses.begin(), poses.end(),
                    [&](const WeightedPose& possible) {
                      return distance(possible.pose, {row.x(), 0.0, 0.0}) < 0.5 && std::abs(possible.pose.theta) < 0.2;
                    }))
        << "listed from lamp " << first;
    EXPECT_NE(localizer.estimate().state, LocalizerState::kTracking) << "listed from lamp " << first;
  }
}

TEST(ModernLocalizer, LeavesTrackingWhenOdometryJumps) {
  const TestBuilding building = testing::two_rooms();
  SyntheticWorld world(building.building, building.walls, robot(), {.seed = 1002, .clutter = 0});
  ModernLocalizer localizer(building.building, building.walls, robot(), ErrorParams{}, ModernLocalizerParams{});
  run_trial(world, localizer, {.duration = 120.0});
  ASSERT_EQ(localizer.estimate().state, LocalizerState::kTracking);
  localizer.add_odometry({world.utime() + 100'000, 1, {1000.0, 10.0, 0.0}, 0.0, 0.0});
  EXPECT_EQ(localizer.estimate().state, LocalizerState::kAmbiguous);
}

// A round lamp overhead tells the place and no heading. A robot that is sure of its pose in one image and not in the
// next would stand there for ever: whoever drives it never learns that it must look for another lamp.
TEST(ModernLocalizer, IsNotSureBelowARoundLampUntilItsHeadingIsKnown) {
  Building building;
  building.ceiling_height = 2.8;
  building.fixtures.resize(2);
  for (Fixture& lamp : building.fixtures) {
    lamp.shape = FixtureShape::kRound;
    lamp.length = lamp.width = 0.4;
  }
  building.fixtures[1].world_from_fixture.x = 2.4;
  ModernLocalizer localizer(building, PriorMap{}, robot(), ErrorParams{}, {});
  localizer.recall({Pose2{}, Eigen::Vector3d(1e-4, 1e-4, std::pow(radians(12.0), 2)).asDiagonal()});
  double x = 0.0;
  std::int64_t utime = 1'000'000'000;
  const auto step = [&](double linear) {
    utime += 100'000;
    x += 0.1 * linear;
    localizer.add_odometry({utime, 1, {x, 0.0, 0.0}, linear, 0.0});
    SightingFrame frame{utime, {}};
    for (const Fixture& lamp : building.fixtures) {
      const double ahead = lamp.world_from_fixture.x - x;
      if (std::abs(ahead) < 0.6) {
        FixtureSighting& sighting = frame.sightings.emplace_back();
        sighting.robot_from_fixture = {ahead, 0.0, 0.0};
        sighting.covariance = Eigen::Vector3d(1e-5, 1e-5, 10.0).asDiagonal();
        sighting.shape = FixtureShape::kRound;
        sighting.has_theta = false;
        sighting.length = sighting.width = lamp.length;
        sighting.state = SightingState::kLit;
      }
    }
    localizer.add_frame(frame);
  };
  for (int i = 0; i < 50; ++i) {
    step(0.0);
    EXPECT_EQ(localizer.estimate().state, LocalizerState::kAmbiguous);
  }
  while (x < 2.4) {
    step(0.4);
  }
  EXPECT_EQ(localizer.estimate().state, LocalizerState::kTracking) << localizer.estimate().reason;
}

// The filter learns below lamps how the wheels err, and the hypotheses do not. After a long way without one they have
// the pose elsewhere: what fits the filter is no reason to search anew.
TEST(ModernLocalizer, GoesOnByTheFirstLampAfterALongBlindWay) {
  constexpr double kTurn = radians(1.0);  // per metre, which the wheels do not notice
  constexpr double kFar = 24.0;           // [m]
  const auto truth_after = [](double way) {
    return Pose2{std::sin(kTurn * way) / kTurn, (1.0 - std::cos(kTurn * way)) / kTurn, kTurn * way};
  };
  Building building;
  building.ceiling_height = 2.8;
  for (const double way : {0.0, 2.4, 4.8, 7.2, 9.6, kFar}) {
    building.fixtures.emplace_back().world_from_fixture = truth_after(way);
  }
  ModernLocalizer localizer(building, PriorMap{}, robot(), ErrorParams{}, {});
  localizer.recall({Pose2{}, 1e-4 * Eigen::Matrix3d::Identity()});
  std::int64_t utime = 1'000'000'000;
  for (double way = 0.0; way < kFar + 0.5; way += 0.04) {
    utime += 100'000;
    localizer.add_odometry({utime, 1, {way, 0.0, 0.0}, 0.4, 0.0});
    SightingFrame frame{utime, {}};
    for (const Fixture& lamp : building.fixtures) {
      const Pose2 seen = truth_after(way).inverse() * lamp.world_from_fixture;
      if (std::hypot(seen.x, seen.y) < 0.6) {
        FixtureSighting& sighting = frame.sightings.emplace_back();
        sighting.robot_from_fixture = seen;
        sighting.covariance = 1e-5 * Eigen::Matrix3d::Identity();
        sighting.length = lamp.length;
        sighting.width = lamp.width;
        sighting.state = SightingState::kLit;
      }
    }
    localizer.add_frame(frame);
    EXPECT_EQ(localizer.estimate().reason.find("anew"), std::string::npos) << way;
  }
  EXPECT_EQ(localizer.estimate().state, LocalizerState::kTracking) << localizer.estimate().reason;
}

TEST(ModernLocalizer, GivesTheSameAnswersTwice) {
  const TestBuilding building = testing::two_rooms();
  const auto run = [&] {
    SyntheticWorld world(building.building, building.walls, robot(), {.seed = 1003});
    ModernLocalizer localizer(building.building, building.walls, robot(), ErrorParams{}, ModernLocalizerParams{});
    run_trial(world, localizer, {.duration = 20.0});
    return localizer.estimate().belief;
  };
  const PoseBelief one = run();
  const PoseBelief other = run();
  EXPECT_EQ(one.pose.x, other.pose.x);
  EXPECT_EQ(one.pose.theta, other.pose.theta);
  EXPECT_EQ(one.covariance, other.covariance);
}

}  // namespace
}  // namespace luminav
