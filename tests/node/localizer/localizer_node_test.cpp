#include "services/localizer/localizer_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <luminav/hypotheses_t.hpp>
#include <luminav/pose_t.hpp>
#include <vector>

#include "services/common/process/channels.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

LocalizerConfig config_of(const testing::TestBuilding& building) {
  LocalizerConfig config;
  config.building = building.building;
  config.walls = building.walls;
  config.robot.camera.mounting.z = 0.3;
  for (int i = 0; i < 16; ++i) {
    const double angle = wrap_angle(2.0 * kPi * i / 16.0);
    config.robot.sonar.robot_from_sonar.push_back({0.2 * std::cos(angle), 0.2 * std::sin(angle), angle});
  }
  return config;
}

odometry_t to_message(const OdometryReading& reading, int sequence) {
  odometry_t message{};
  message.utime = reading.utime;
  message.session = reading.session;
  message.sequence = sequence;
  message.x = reading.odom_from_robot.x;
  message.y = reading.odom_from_robot.y;
  message.theta = reading.odom_from_robot.theta;
  message.linear = reading.linear;
  message.angular = reading.angular;
  return message;
}

fixture_detections_t to_message(const SightingFrame& frame) {
  fixture_detections_t message{};
  message.utime = frame.utime;
  for (const FixtureSighting& sighting : frame.sightings) {
    fixture_detection_t detection{};
    detection.shape = fixture_detection_t::SHAPE_RECTANGLE;
    detection.has_theta = 1;
    detection.x = sighting.robot_from_fixture.x;
    detection.y = sighting.robot_from_fixture.y;
    detection.theta = sighting.robot_from_fixture.theta;
    for (int i = 0; i < 9; ++i) {
      detection.covariance[i] = sighting.covariance(i / 3, i % 3);
    }
    detection.length = sighting.length;
    detection.width = sighting.width;
    detection.clipped = sighting.clipped ? 1 : 0;
    detection.fit = 1.0;
    message.detections.push_back(detection);
  }
  message.count = static_cast<std::int32_t>(message.detections.size());
  return message;
}

sonar_t to_message(const SonarScan& scan) {
  sonar_t message{};
  message.utime = scan.utime;
  message.session = scan.session;
  message.count = 16;
  message.range.assign(16, 5.0F);
  message.has_echo.assign(16, 0);
  message.fresh.assign(16, 0);
  message.range_utime.assign(16, 0);
  for (const auto& reading : scan.readings) {
    const auto disc = static_cast<std::size_t>(reading.disc);
    message.range[disc] = static_cast<float>(reading.range);
    message.has_echo[disc] = reading.has_echo ? 1 : 0;
    message.fresh[disc] = 1;
    message.range_utime[disc] = reading.utime;
  }
  return message;
}

class LocalizerNodeTest : public ::testing::Test {
 protected:
  LocalizerNodeTest() {
    lcm_.subscribe(channels::kPose, &LocalizerNodeTest::on_pose, this);
    lcm_.subscribe(channels::kHypotheses, &LocalizerNodeTest::on_hypotheses, this);
  }
  void on_pose(const lcm::ReceiveBuffer*, const std::string&, const pose_t* message) { poses_.push_back(*message); }
  void on_hypotheses(const lcm::ReceiveBuffer*, const std::string&, const hypotheses_t* message) {
    hypotheses_.push_back(*message);
  }
  void handle_all() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void send_odometry(std::int64_t utime, double x = 0.0, std::int64_t session = 1) {
    const odometry_t message = to_message({utime, session, {x, 0.0, 0.0}, 0.0, 0.0}, ++sequence_);
    lcm_.publish(channels::kOdometry, &message);
    handle_all();
  }

  testing::TestBuilding building_ = testing::two_rooms();
  lcm::LCM lcm_{"memq://"};
  LocalizerNode node_{lcm_, config_of(building_)};
  std::vector<pose_t> poses_;
  std::vector<hypotheses_t> hypotheses_;
  int sequence_ = 0;
};

TEST_F(LocalizerNodeTest, AnswersEachOdometryWithAPoseOfItsStampEvenWhenLost) {
  send_odometry(1'000'000);
  send_odometry(1'100'000);
  ASSERT_EQ(poses_.size(), 2U);
  EXPECT_EQ(poses_[1].utime, 1'100'000);
  EXPECT_EQ(poses_[1].state, pose_t::STATE_LOST);
  EXPECT_FALSE(poses_[1].reason.empty());
  EXPECT_GE(poses_[1].covariance[0], 1e5);
}

TEST_F(LocalizerNodeTest, FindsAndFollowsThePoseOverTheBus) {
  testing::SyntheticOptions options;
  options.seed = 1000;
  options.clutter = 0;
  const LocalizerConfig config = config_of(building_);
  testing::SyntheticWorld world(building_.building, building_.walls, config.robot, options);
  double worst = 0.0;
  int tracking = 0;
  for (int i = 0; i < 30 * 90; ++i) {
    const auto output = world.step();
    if (output.sonar) {
      const sonar_t message = to_message(*output.sonar);
      lcm_.publish(channels::kSonar, &message);
    }
    if (output.frame) {
      const fixture_detections_t message = to_message(*output.frame);
      lcm_.publish(channels::kFixtureDetections, &message);
    }
    if (output.odometry) {
      const odometry_t message = to_message(*output.odometry, i);
      lcm_.publish(channels::kOdometry, &message);
    }
    handle_all();
    if (output.odometry && poses_.back().state == pose_t::STATE_TRACKING) {
      ++tracking;
      worst = std::max(worst, std::hypot(poses_.back().x - world.truth().x, poses_.back().y - world.truth().y));
    }
  }
  EXPECT_EQ(poses_.size(), 900U);
  EXPECT_GT(tracking, 300);
  EXPECT_LT(worst, 0.25);
  // the images taken before the first odometry
  EXPECT_LE(node_.health().dropped_inputs, 2);
  EXPECT_LE(hypotheses_.size(), 5U * 90U + 1U);
  EXPECT_GT(hypotheses_.size(), 200U);
}

TEST_F(LocalizerNodeTest, DropsNumbersThatAreNone) {
  send_odometry(1'000'000);
  send_odometry(1'100'000, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(poses_.size(), 1U);
  SightingFrame frame{1'050'000, {{}}};
  frame.sightings.front().robot_from_fixture.x = std::numeric_limits<double>::infinity();
  frame.sightings.front().length = 1.2;
  frame.sightings.front().width = 0.3;
  const fixture_detections_t message = to_message(frame);
  lcm_.publish(channels::kFixtureDetections, &message);
  handle_all();
  EXPECT_EQ(node_.health().dropped_inputs, 2);
}

TEST_F(LocalizerNodeTest, DropsOldOdometryAndGoesOnAfterTheClockWasSetBack) {
  send_odometry(10'000'000);
  send_odometry(9'900'000);
  EXPECT_EQ(poses_.size(), 1U);
  send_odometry(1'000'000);
  send_odometry(1'100'000);
  send_odometry(1'200'000);
  EXPECT_EQ(poses_.size(), 2U);
  EXPECT_EQ(poses_.back().utime, 1'200'000);
}

TEST_F(LocalizerNodeTest, RefusesTenThousandDetectionsInOneMessage) {
  SightingFrame frame{1'050'000, std::vector<FixtureSighting>(600)};
  const fixture_detections_t message = to_message(frame);
  lcm_.publish(channels::kFixtureDetections, &message);
  handle_all();
  EXPECT_EQ(node_.health().dropped_inputs, 1);
}

TEST_F(LocalizerNodeTest, SurvivesBytesThatDoNotDecode) {
  const char garbage[] = "not a message";
  for (const char* channel : {channels::kOdometry, channels::kFixtureDetections, channels::kSonar,
                              channels::kInitialPose, channels::kRobotStatus}) {
    lcm_.publish(channel, garbage, sizeof garbage);
  }
  handle_all();
  EXPECT_EQ(node_.health().dropped_inputs, 5);
  send_odometry(1'000'000);
  EXPECT_EQ(poses_.size(), 1U);
}

TEST_F(LocalizerNodeTest, TakesAGuessAsAHypothesisAndEchoesItsId) {
  send_odometry(1'000'000);
  initial_pose_t guess{};
  guess.id = 77;
  guess.x = 4.0;
  guess.y = 3.0;
  guess.covariance[0] = guess.covariance[4] = guess.covariance[8] = 0.01;
  lcm_.publish(channels::kInitialPose, &guess);
  handle_all();
  send_odometry(1'100'000);
  EXPECT_EQ(poses_.back().initial_pose_id, 77);
  EXPECT_EQ(poses_.back().state, pose_t::STATE_AMBIGUOUS);
  EXPECT_NEAR(poses_.back().x, 4.0, 1e-9);
}

TEST(LocalizerNodeConfig, ReadsTheShippedRobotAndBuildings) {
  const std::filesystem::path launch = std::string(LUMINAV_SOURCE_DIR) + "/launch";
  for (const auto& entry : std::filesystem::directory_iterator(launch / "buildings")) {
    const LocalizerConfig config = read_localizer_config(launch / "robots/p3dx.toml", entry.path() / "building.toml");
    EXPECT_GT(config.building.fixtures.size(), 0U) << entry.path();
  }
}

TEST(LocalizerNodeConfig, RejectsUnknownKeysWithFileAndLine) {
  const std::filesystem::path launch = std::string(LUMINAV_SOURCE_DIR) + "/launch";
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "localizer_robot.toml";
  {
    std::ofstream copy(file);
    copy << std::ifstream(launch / "robots/p3dx.toml").rdbuf() << "\n[localizer.rules]\nenter_marginn = 3.0\n";
  }
  const auto building = launch / "buildings/laboratory/building.toml";
  try {
    read_localizer_config(file, building);
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_NE(std::string(error.what()).find("enter_marginn"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace luminav
