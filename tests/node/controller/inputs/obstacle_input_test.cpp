#include "services/controller/inputs/obstacle_input.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;  // [us]
constexpr std::int64_t kSession = 5;

class ObstacleInputTest : public ::testing::Test {
 protected:
  ObstacleInputTest() {
    odometry_t message{};
    message.utime = kNow;
    message.session = kSession;
    odometry_.add(message);
  }
  /// All discs hear something at this range [m].
  [[nodiscard]] sonar_t heard(float range, std::int64_t utime) const {
    sonar_t message{};
    message.utime = utime;
    message.session = kSession;
    message.count = static_cast<std::int32_t>(robot_.sonar.robot_from_sonar.size());
    const auto count = static_cast<std::size_t>(message.count);
    message.range.assign(count, range);
    message.has_echo.assign(count, 1);
    message.range_utime.assign(count, utime);
    message.fresh.assign(count, 1);
    return message;
  }
  void take(const sonar_t& message) {
    input_.take(message, odometry_, {}, [this](const char* why) { dropped_.emplace_back(why); });
  }
  [[nodiscard]] ControlInput described(ControlTask task, std::int64_t utime) const {
    ControlInput input;
    input.task = task;
    input_.describe(utime, {}, input);
    return input;
  }

  RobotDescription robot_ = testing::test_robot();
  RecentOdometry odometry_;
  ObstacleInput input_{robot_, EchoMemoryParams{}};
  std::vector<std::string> dropped_;
};

TEST_F(ObstacleInputTest, RemembersEchoesUntilTheOdometryJumps) {
  take(heard(1.0F, kNow));
  EXPECT_FALSE(described(ControlTask::kFollow, kNow).echoes.empty());
  EXPECT_TRUE(described(ControlTask::kFollow, kNow).remembered.empty()) << "for who wanders alone";
  EXPECT_FALSE(described(ControlTask::kWander, kNow).remembered.empty());
  SenseAges ages;
  input_.judge(kNow + 100'000, ages);
  EXPECT_NEAR(ages.sonar, 0.1, 1e-9);
  input_.clear();
  EXPECT_TRUE(described(ControlTask::kWander, kNow).echoes.empty());
}

TEST_F(ObstacleInputTest, RemembersWhatTheRobotRanInto) {
  input_.feel(kNow, {}, {0.3, 0.0});
  ASSERT_FALSE(described(ControlTask::kFollow, kNow).echoes.empty());
  EXPECT_GT(described(ControlTask::kFollow, kNow).echoes.front().position.x(), 0.0) << "before the side that drove";
}

TEST_F(ObstacleInputTest, DropsReadingsThatCannotBe) {
  sonar_t fewer = heard(1.0F, kNow);
  fewer.range.pop_back();
  take(fewer);
  take(heard(-1.0F, kNow + 1000));
  take(heard(1.0F, kNow + 3'600'000'000));
  EXPECT_EQ(dropped_.size(), 1 + 2 * robot_.sonar.robot_from_sonar.size());
  EXPECT_TRUE(described(ControlTask::kFollow, kNow).echoes.empty());
  sonar_t of_another = heard(1.0F, kNow);
  of_another.session = kSession + 1;
  take(of_another);
  EXPECT_TRUE(described(ControlTask::kFollow, kNow).echoes.empty()) << "nobody knows where it was";
  take(heard(1.0F, kNow - 3'600'000'000));
  EXPECT_EQ(dropped_.size(), 1 + 2 * robot_.sonar.robot_from_sonar.size()) << "before it listened is no fault";
}

}  // namespace
}  // namespace luminav
