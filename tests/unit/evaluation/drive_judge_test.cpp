#include "tests/evaluation/judge/drive_judge.hpp"

#include <gtest/gtest.h>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

/// A corridor along x: walls at 0 and 2 m, 10 m long, open at its ends.
WorldTruth corridor() {
  WorldTruth world;
  world.walls.geometry.columns = 200;
  world.walls.geometry.rows = 60;
  world.walls.geometry.resolution = 0.05;
  world.walls.cells.assign(200 * 60, Prior::kFree);
  for (int column = 0; column < 200; ++column) {
    for (const double y : {-0.05, 2.0}) {
      world.walls.cells[world.walls.geometry.index(world.walls.geometry.cell_at(
          {0.05 * column + 0.02 + world.walls.geometry.origin.x(), y + 0.52 + world.walls.geometry.origin.y()}))] =
          Prior::kOccupied;
    }
  }
  world.robot.footprint = {{0.21, -0.2}, {0.21, 0.2}, {-0.3, 0.2}, {-0.3, -0.2}};
  return world;
}

class DriveJudgeTest : public ::testing::Test {
 protected:
  /// Publishes and handles.
  template <typename Message>
  void say(const char* channel, const Message& message) {
    lcm_.publish(channel, &message);
    lcm_.handle();
  }
  void turn(double at, double angular) {
    velocity_command_t command{};
    command.utime = 1'000'000 + static_cast<std::int64_t>(1e6 * at);
    command.angular_z = angular;
    say(channels::kVelocityCommand, command);
  }
  static sim_truth_t truth_at(double x, double y, double theta) {
    sim_truth_t truth{};
    truth.utime = 2'000'000;
    truth.x = x;
    truth.y = y;
    truth.theta = theta;
    truth.linear = 0.4;
    return truth;
  }

  lcm::LCM lcm_{"memq://"};
  WorldTruth world_ = corridor();
  DriveJudge judge_{lcm_, world_};
};

TEST_F(DriveJudgeTest, MeasuresTheNearerSideOfACorridorOnly) {
  const auto middle = corridor_gap(world_.walls, {5.0, 1.5, 0.0}, 0.2);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->nearer, 0.8, 0.06);
  EXPECT_NEAR(middle->middle, 0.8, 0.06);
  const auto beside = corridor_gap(world_.walls, {5.0, 1.0, kPi}, 0.2);
  ASSERT_TRUE(beside);
  EXPECT_NEAR(beside->nearer, 0.3, 0.06);
  EXPECT_FALSE(corridor_gap(world_.walls, {5.0, 1.5, 1.0}, 0.2));
}

TEST_F(DriveJudgeTest, NamesWhatWasTouched) {
  sim_truth_t truth = truth_at(5.0, 1.5, 0.0);
  truth.contacts = 1;
  truth.people = 1;
  truth.person_x = {5.46F};
  truth.person_y = {1.5F};
  say(channels::kSimTruth, truth);
  truth.contacts = 2;
  truth.person_x = {9.0F};
  say(channels::kSimTruth, truth);
  truth.hard_contacts = 1;
  say(channels::kSimTruth, truth);
  const DriveResult result = judge_.result();
  ASSERT_EQ(result.contacts.size(), 3U);
  EXPECT_EQ(result.contacts[0].with, "person");
  EXPECT_EQ(result.contacts[1].with, "wall");
  EXPECT_EQ(result.contacts[2].with, "hard");
}

TEST_F(DriveJudgeTest, FindsSteeringToAndFroButNoBends) {
  for (int i = 0; i < 200; ++i) {
    turn(0.02 * i, i / 50 % 2 == 0 ? 0.3 : -0.3);  // once a second
  }
  EXPECT_DOUBLE_EQ(judge_.result().oscillation_s, 0.0);
  for (int i = 0; i < 200; ++i) {
    turn(4.0 + 0.02 * i, i / 10 % 2 == 0 ? 0.3 : -0.3);  // five times a second
  }
  EXPECT_GT(judge_.result().oscillation_s, 1.0);
}

}  // namespace
}  // namespace luminav
