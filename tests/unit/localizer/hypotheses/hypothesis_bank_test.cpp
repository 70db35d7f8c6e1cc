// The bank of hypotheses in a hall with a thousand fixtures: bounded work in each step, and the same in the end as when
// all is done at once.

#include "services/localizer/hypotheses/hypothesis_bank.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "services/localizer/modern_localizer.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

using testing::SyntheticOptions;
using testing::SyntheticWorld;
using testing::TestBuilding;

constexpr int kBounded = 5000;          // [units]
constexpr int kUnbounded = 1000000000;  // [units]
constexpr int kLastPiece = 100;         // [units] that are done before the budget is looked at again

RobotDescription robot() {
  RobotDescription robot;
  robot.camera.mounting.z = 0.3;
  for (int i = 0; i < 16; ++i) {
    const double angle = wrap_angle(2.0 * kPi * i / 16.0);
    robot.sonar.robot_from_sonar.push_back({0.2 * std::cos(angle), 0.2 * std::sin(angle), angle});
  }
  return robot;
}

/// A robot that stands at a place and sees without errors.
SyntheticOptions standing_at(const Pose2& place) {
  return {.seed = 3,
          .perfect = true,
          .miss_lit = 0.0,
          .false_alarm = 0.0,
          .clutter = 0,
          .unknown_boxes = 0,
          .speed = 0.0,
          .start = place};
}

/// 90 m x 80 m, fixtures every 3 m and 2.4 m with gaps and offsets as an architect's mistakes would make them.
TestBuilding hall() {
  TestBuilding result;
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> offset(-0.4, 0.4);
  result.building.ceiling_height = 2.8;
  for (int row = 0; row < 33; ++row) {
    for (int column = 0; column < 30; ++column) {
      Fixture fixture;
      fixture.id = static_cast<int>(result.building.fixtures.size()) + 1;
      fixture.world_from_fixture = {3.0 * column + 1.5 + offset(generator), 2.4 * row + 1.2 + offset(generator),
                                    generator() % 3 == 0 ? 0.5 * kPi : 0.0};
      if (generator() % 5 != 0) {
        result.building.fixtures.push_back(fixture);
      }
    }
  }
  result.walls.geometry = {0.1, {0.0, 0.0}, 900, 800};
  result.walls.cells.assign(result.walls.geometry.size(), Prior::kFree);
  for (int row = 0; row < 800; ++row) {
    for (int column = 0; column < 900; ++column) {
      if (row == 0 || row == 799 || column == 0 || column == 899) {
        result.walls.cells[result.walls.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return result;
}

class HypothesisBankInAHall : public ::testing::Test {
 protected:
  struct Drive {
    std::unique_ptr<ModernLocalizer> localizer;
    Pose2 truth;
    int max_work = 0;       // [units] in one step
    int longest_round = 0;  // [steps]
    int torn = 0;           // parts by sonar that changed without the score they are part of
  };

  Drive drive(int work, const SyntheticOptions& options, double duration) {
    SyntheticWorld world(hall_.building, hall_.walls, robot(), options);
    ModernLocalizerParams params;
    params.hypotheses.work = work;
    Drive drive;
    drive.localizer = std::make_unique<ModernLocalizer>(hall_.building, hall_.walls, robot(), ErrorParams{}, params);
    int busy = 0;
    std::map<int, std::pair<double, double>> sonar_parts;  // by hypothesis, behind what they are part of
    for (int step = 0; step < static_cast<int>(30.0 * duration); ++step) {
      const SyntheticWorld::Output output = world.step();
      if (output.sonar) {
        drive.localizer->add_sonar(*output.sonar);
      }
      if (output.frame) {
        drive.localizer->add_frame(*output.frame);
      }
      if (!output.odometry) {
        continue;
      }
      drive.localizer->add_odometry(*output.odometry);
      const HypothesisBank& bank = drive.localizer->bank();
      drive.max_work = std::max(drive.max_work, bank.work_done());
      constexpr double kRounding = 1e-9;
      for (const Hypothesis& hypothesis : bank.hypotheses()) {
        const auto known = sonar_parts.find(hypothesis.id);
        const bool is_another_part =
            known != sonar_parts.end() && std::abs(known->second.second - hypothesis.sonar_part) > kRounding;
        drive.torn += is_another_part && known->second.first == hypothesis.log_posterior ? 1 : 0;
        sonar_parts[hypothesis.id] = {hypothesis.log_posterior, hypothesis.sonar_part};
      }
      busy = bank.is_busy() ? busy + 1 : 0;
      drive.longest_round = std::max(drive.longest_round, busy);
    }
    drive.truth = world.truth();
    return drive;
  }

  TestBuilding hall_ = hall();
};

TEST_F(HypothesisBankInAHall, BearsTheSamePosesInManyStepsAsInOne) {
  const SyntheticOptions still = standing_at({40.0, 40.0, 0.3});
  const Drive at_once = drive(kUnbounded, still, 6.0);
  const int little = kBounded / 2;
  const Drive in_turn = drive(little, still, 6.0);
  const std::vector<Hypothesis>& all = at_once.localizer->bank().hypotheses();
  const std::vector<Hypothesis>& same = in_turn.localizer->bank().hypotheses();
  EXPECT_GT(in_turn.longest_round, 1);
  EXPECT_GT(at_once.max_work, 2 * kBounded);
  EXPECT_LE(in_turn.max_work, little + kLastPiece);
  EXPECT_GT(all.size(), 30U);
  ASSERT_EQ(all.size(), same.size());
  for (const Hypothesis& one : all) {
    EXPECT_TRUE(std::any_of(same.begin(), same.end(),
                            [&](const Hypothesis& other) {
                              return distance(one.belief.pose, other.belief.pose) < 0.01 &&
                                     std::abs(wrap_angle(one.belief.pose.theta - other.belief.pose.theta)) < 0.01;
                            }))
        << one.belief.pose.x << " " << one.belief.pose.y << " " << one.belief.pose.theta;
  }
}

TEST_F(HypothesisBankInAHall, DoesBoundedWorkInEachStepAndFindsThePoseAllTheSame) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const SyntheticOptions options{.seed = seed, .clutter = 0};
    const Drive in_turn = drive(kBounded, options, 60.0);
    EXPECT_LE(in_turn.max_work, kBounded + kLastPiece) << "seed " << seed;
    EXPECT_GT(in_turn.longest_round, 1) << "seed " << seed;
    EXPECT_EQ(in_turn.torn, 0) << "seed " << seed;
    ASSERT_EQ(in_turn.localizer->estimate().state, LocalizerState::kTracking) << "seed " << seed;
    EXPECT_LT(distance(in_turn.localizer->estimate().belief.pose, in_turn.truth), 0.25) << "seed " << seed;
  }
}

TEST(HypothesisBank, APoseThatExplainsNothingKeepsTheRightOneBesideItNotOut) {
  TestBuilding hall;
  hall.building.ceiling_height = 2.8;
  Fixture lamp;
  lamp.id = 1;
  lamp.world_from_fixture = {5.0, 5.0, 0.0};
  hall.building.fixtures.push_back(lamp);
  const Pose2 start{5.1, 4.8, 0.3};
  SyntheticWorld world(hall.building, hall.walls, robot(), standing_at(start));
  ModernLocalizer localizer(hall.building, hall.walls, robot(), ErrorParams{}, {});
  const PoseBelief beside{{5.1 + 0.2, 4.8 - 0.15, 0.3}, Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal()};
  localizer.add_guess(beside);
  for (int step = 0; step < 60; ++step) {
    const SyntheticWorld::Output output = world.step();
    if (output.frame) {
      localizer.add_frame(*output.frame);
    }
    if (output.odometry) {
      localizer.add_odometry(*output.odometry);
    }
  }
  const std::vector<Hypothesis>& all = localizer.bank().hypotheses();
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Hypothesis& hypothesis) {
    return distance(hypothesis.belief.pose, start) < 0.05 && !hypothesis.confirmed.empty();
  }));
}

}  // namespace
}  // namespace luminav
