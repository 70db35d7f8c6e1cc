#include "services/localizer/localizer_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <luminav/hypotheses_t.hpp>
#include <luminav/pose_t.hpp>
#include <optional>
#include <set>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/localizer/pose_memory.hpp"
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
  message.session = 1;
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

 public:
  void on_pose(const lcm::ReceiveBuffer*, const std::string&, const pose_t* message) { poses_.push_back(*message); }
  void on_hypotheses(const lcm::ReceiveBuffer*, const std::string&, const hypotheses_t* message) {
    hypotheses_.push_back(*message);
  }

 protected:
  void handle_all() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void send_odometry(std::int64_t utime, double x = 0.0, std::int64_t session = 1) {
    const odometry_t message = to_message({utime, session, {x, 0.0, 0.0}, 0.0, 0.0}, ++sequence_);
    lcm_.publish(channels::kOdometry, &message);
    handle_all();
  }
  void send_frame(std::int64_t utime) {
    const fixture_detections_t message = to_message(SightingFrame{utime, {}});
    lcm_.publish(channels::kFixtureDetections, &message);
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
  std::set<std::int64_t> stamps;
  for (const pose_t& pose : poses_) {
    stamps.insert(pose.utime);
  }
  EXPECT_EQ(stamps.size(), 900U) << "of ODOMETRY, whatever images tell";
  EXPECT_GT(tracking, 300);
  EXPECT_LT(worst, 0.25);
  // the images taken before the first odometry
  EXPECT_LE(node_.health().dropped_inputs, 2);
  EXPECT_LE(hypotheses_.size(), 5U * 90U + 1U);
  EXPECT_GT(hypotheses_.size(), 200U);
}

TEST_F(LocalizerNodeTest, MissesNoUnlitFixtureInPicturesForLamps) {
  testing::SyntheticOptions options;
  options.seed = 1000;
  options.clutter = 0;
  testing::SyntheticWorld world(building_.building, building_.walls, config_of(building_).robot, options);
  int frames = 0;
  int suspected = 0;
  for (int i = 0; i < 30 * 120; ++i) {
    const auto output = world.step();
    if (output.frame) {
      const bool is_for_lamps = i > 30 * 60 && ++frames / 12 % 2 == 1;
      fixture_detections_t message = to_message(is_for_lamps ? SightingFrame{output.frame->utime, {}} : *output.frame);
      message.exposure_us = is_for_lamps ? 560.0 : 8000.0;
      lcm_.publish(channels::kFixtureDetections, &message);
    }
    if (output.odometry) {
      const odometry_t message = to_message(*output.odometry, i);
      lcm_.publish(channels::kOdometry, &message);
    }
    handle_all();
    suspected +=
        output.odometry && i > 30 * 60 && poses_.back().reason.find("is not seen") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(suspected, 0);
}

TEST_F(LocalizerNodeTest, AddsTheCamerasTimeOffsetToTheStampOfAnImage) {
  LocalizerConfig late = config_of(building_);
  late.robot.camera.time_offset = 0.25;
  lcm::LCM other_lcm("memq://");
  LocalizerNode other(other_lcm, late);
  other_lcm.subscribe(channels::kPose, &LocalizerNodeTest::on_pose, static_cast<LocalizerNodeTest*>(this));
  testing::SyntheticOptions options;
  options.seed = 1000;
  options.clutter = 0;
  testing::SyntheticWorld world(building_.building, building_.walls, config_of(building_).robot, options);
  for (int i = 0; i < 30 * 60; ++i) {
    const auto output = world.step();
    if (output.frame) {
      fixture_detections_t message = to_message(*output.frame);
      lcm_.publish(channels::kFixtureDetections, &message);
      message.utime -= 250'000;  // as a camera does that stamps a quarter of a second early
      other_lcm.publish(channels::kFixtureDetections, &message);
    }
    if (!output.odometry) {
      continue;
    }
    const odometry_t message = to_message(*output.odometry, i);
    lcm_.publish(channels::kOdometry, &message);
    other_lcm.publish(channels::kOdometry, &message);
    poses_.clear();
    handle_all();
    const std::vector<pose_t> punctual = std::move(poses_);
    poses_.clear();
    while (other_lcm.handleTimeout(0) > 0) {
    }
    ASSERT_EQ(poses_.size(), punctual.size());
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      EXPECT_EQ(poses_[k].x, punctual[k].x);
      EXPECT_EQ(poses_[k].y, punctual[k].y);
      EXPECT_EQ(poses_[k].state, punctual[k].state);
    }
  }
  ASSERT_FALSE(poses_.empty());
  EXPECT_EQ(poses_.back().state, pose_t::STATE_TRACKING);
}

/// Two localizers on one drive through fixtures: the images of the second arrive later.
class ImageAtOnceTest : public LocalizerNodeTest {
 protected:
  ImageAtOnceTest() { later_lcm_.subscribe(channels::kPose, &ImageAtOnceTest::on_later_pose, this); }
  static testing::SyntheticOptions options() {
    testing::SyntheticOptions options;
    options.seed = 1000;
    options.clutter = 0;
    options.image_latency = 0.0;
    return options;
  }
  /// Until both follow the pose and a fixture is in view.
  void find_the_pose() {
    for (int i = 0; i < 30 * 90 && !is_following(); ++i) {
      go_on();
    }
    ASSERT_TRUE(is_following());
  }
  /// 1/30 s: the images reach the second localizer with the next odometry.
  void go_on() {
    const auto output = world_.step();
    if (output.frame) {
      send(lcm_, channels::kFixtureDetections, to_message(*output.frame));
      late_.push_back(*output.frame);
      newest_image_ = output.frame->utime;
    }
    if (!output.odometry) {
      return;
    }
    const odometry_t odometry = to_message(*output.odometry, ++sequence_);
    send(lcm_, channels::kOdometry, odometry);
    send(later_lcm_, channels::kOdometry, odometry);
    for (const SightingFrame& frame : late_) {
      send(later_lcm_, channels::kFixtureDetections, to_message(frame));
    }
    late_.clear();
  }
  template <typename Message>
  void send(lcm::LCM& lcm, const char* channel, const Message& message) {
    lcm.publish(channel, &message);
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  [[nodiscard]] bool is_following() const {
    return !poses_.empty() && poses_.back().state == pose_t::STATE_TRACKING &&
           poses_.back().fixture_utime >= poses_.back().utime;
  }
  void on_later_pose(const lcm::ReceiveBuffer*, const std::string&, const pose_t* message) {
    later_poses_.push_back(*message);
  }

  testing::SyntheticWorld world_{building_.building, building_.walls, config_of(building_).robot, options()};
  lcm::LCM later_lcm_{"memq://"};
  LocalizerNode later_{later_lcm_, config_of(building_)};
  std::vector<pose_t> later_poses_;
  std::vector<SightingFrame> late_;
  std::int64_t newest_image_ = 0;  // [us]
};

TEST_F(ImageAtOnceTest, CorrectsThePoseBeforeOdometryReachesIt) {
  find_the_pose();
  int corrected = 0;
  for (int i = 0; i < 30 * 10; ++i) {
    const std::size_t before = poses_.size();
    const pose_t last = poses_.back();
    go_on();
    for (std::size_t k = before; k < poses_.size(); ++k) {
      if (poses_[k].utime == last.utime && poses_[k].fixture_utime > last.utime) {
        ++corrected;
        EXPECT_EQ(poses_[k].sequence, last.sequence + 1);
        EXPECT_EQ(poses_[k].session, last.session);
        EXPECT_LT(std::hypot(poses_[k].x - last.x, poses_[k].y - last.y), 0.1) << "one image's worth";
        break;
      }
    }
  }
  EXPECT_GT(corrected, 20);
}

TEST_F(ImageAtOnceTest, EndsWhereOneDoesThatWaitedForOdometry) {
  find_the_pose();
  int compared = 0;
  for (int i = 0; i < 30 * 20; ++i) {
    go_on();
    if (!late_.empty() || poses_.back().fixture_utime != newest_image_) {
      continue;  // odometry has not reached the image yet, or it showed no fixture
    }
    ++compared;
    ASSERT_FALSE(later_poses_.empty());
    EXPECT_EQ(poses_.back().utime, later_poses_.back().utime);
    EXPECT_EQ(poses_.back().x, later_poses_.back().x);
    EXPECT_EQ(poses_.back().y, later_poses_.back().y);
    EXPECT_EQ(poses_.back().theta, later_poses_.back().theta);
    EXPECT_EQ(poses_.back().covariance[0], later_poses_.back().covariance[0]);
  }
  EXPECT_GT(compared, 20);
}

TEST_F(ImageAtOnceTest, TakesABurstInItsOrderAndDropsWhatIsOlder) {
  find_the_pose();
  std::vector<fixture_detections_t> burst;
  while (burst.size() < 5) {
    const auto output = world_.step();
    if (output.odometry) {
      send(lcm_, channels::kOdometry, to_message(*output.odometry, ++sequence_));
    }
    if (output.frame) {
      burst.push_back(to_message(*output.frame));
    }
  }
  const pose_t before = poses_.back();
  const std::int64_t dropped = node_.health().dropped_inputs;
  poses_.clear();
  for (const fixture_detections_t& image : burst) {
    lcm_.publish(channels::kFixtureDetections, &image);
  }
  handle_all();
  ASSERT_FALSE(poses_.empty());
  ASSERT_LE(poses_.size(), burst.size());
  std::int64_t used = before.fixture_utime;
  for (const pose_t& pose : poses_) {
    EXPECT_EQ(pose.utime, before.utime);
    EXPECT_GT(pose.fixture_utime, used);
    used = pose.fixture_utime;
  }
  EXPECT_EQ(node_.health().dropped_inputs, dropped);
  poses_.clear();
  send(lcm_, channels::kFixtureDetections, burst.front());
  EXPECT_TRUE(poses_.empty());
  EXPECT_EQ(node_.health().dropped_inputs, dropped + 1);
}

TEST_F(ImageAtOnceTest, BelievesNoOdometryThatHasStopped) {
  find_the_pose();
  const std::int64_t stopped = poses_.back().utime;
  poses_.clear();
  for (int i = 0; i < 30; ++i) {
    if (const auto output = world_.step(); output.frame) {
      send(lcm_, channels::kFixtureDetections, to_message(*output.frame));
    }
  }
  EXPECT_LE(poses_.size(), 3U);
  for (const pose_t& pose : poses_) {
    EXPECT_EQ(pose.utime, stopped);
    EXPECT_LE(pose.fixture_utime, stopped + 150'000);
  }
}

TEST_F(LocalizerNodeTest, DropsNumbersThatAreNone) {
  send_odometry(1'000'000);
  send_odometry(1'100'000, std::numeric_limits<double>::quiet_NaN());
  send_odometry(1'200'000, 1e300);  // what the wheels' correction would sum up to no number
  EXPECT_EQ(poses_.size(), 1U);
  SightingFrame frame{1'050'000, {{}}};
  frame.sightings.front().robot_from_fixture.x = std::numeric_limits<double>::infinity();
  frame.sightings.front().length = 1.2;
  frame.sightings.front().width = 0.3;
  const fixture_detections_t message = to_message(frame);
  lcm_.publish(channels::kFixtureDetections, &message);
  handle_all();
  EXPECT_EQ(node_.health().dropped_inputs, 3);
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

TEST_F(LocalizerNodeTest, OneImageFromTheFutureKeepsNoOtherOut) {
  constexpr std::int64_t kHour = 3'600'000'000;  // [us]
  send_frame(kHour);                             // before any odometry
  for (std::int64_t utime = 1'000'000; utime <= 4'000'000; utime += 100'000) {
    send_odometry(utime);
    send_frame(utime - 50'000);
    if (utime == 2'000'000) {
      send_frame(utime + kHour);
    }
  }
  EXPECT_EQ(node_.localizer().last_frame_used(), 3'950'000);
  EXPECT_FALSE(node_.health().degraded) << node_.health().reason;
}

TEST_F(LocalizerNodeTest, SaysSoWhenImagesComeAndNoneIsUsed) {
  for (std::int64_t utime = 10'000'000; utime <= 13'000'000; utime += 100'000) {
    send_odometry(utime);
    send_frame(utime - 50'000);
  }
  EXPECT_FALSE(node_.health().degraded) << node_.health().reason;
  for (std::int64_t utime = 13'100'000; utime <= 14'500'000; utime += 100'000) {
    send_odometry(utime);
    send_frame(utime - 8'000'000);  // the camera started again with another idea of the time
  }
  EXPECT_TRUE(node_.health().degraded);
  EXPECT_NE(node_.health().reason.find("stamps do not fit"), std::string::npos) << node_.health().reason;
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
  guess.utime = 1'000'000;
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

TEST_F(LocalizerNodeTest, DropsAGuessFromBeforeTheLastOne) {
  send_odometry(1'000'000);
  initial_pose_t guess{};
  guess.utime = 1'000'000;
  guess.id = 78;
  guess.x = 4.0;
  guess.y = 3.0;
  guess.covariance[0] = guess.covariance[4] = guess.covariance[8] = 0.01;
  lcm_.publish(channels::kInitialPose, &guess);
  lcm_.publish(channels::kInitialPose, &guess);  // repeated until the echo arrives: no fault
  handle_all();
  EXPECT_EQ(node_.health().dropped_inputs, 0);
  guess.id = 77;
  guess.x = 2.0;
  guess.covariance[0] = guess.covariance[4] = guess.covariance[8] = 1e-4;
  lcm_.publish(channels::kInitialPose, &guess);
  handle_all();
  send_odometry(1'100'000);
  EXPECT_EQ(node_.health().dropped_inputs, 1);
  EXPECT_EQ(poses_.back().initial_pose_id, 78);
  EXPECT_NEAR(poses_.back().x, 4.0, 1e-9);
  ASSERT_FALSE(hypotheses_.empty());
  EXPECT_EQ(node_.localizer().hypotheses(10).size(), 1U) << "nor does it stay as one of the possible poses";
}

TEST_F(LocalizerNodeTest, RefusesAGuessBeyondEveryBuilding) {
  send_odometry(1'000'000);
  initial_pose_t guess{};
  guess.utime = 1'000'000;
  guess.id = 77;
  guess.x = 1e144;
  guess.covariance[0] = guess.covariance[4] = guess.covariance[8] = 0.01;
  lcm_.publish(channels::kInitialPose, &guess);
  guess.x = 4.0;
  guess.id = 78;
  guess.covariance[4] = 1e300;
  lcm_.publish(channels::kInitialPose, &guess);
  handle_all();
  send_odometry(1'100'000);
  EXPECT_EQ(node_.health().dropped_inputs, 2);
  EXPECT_NE(poses_.back().initial_pose_id, 77);
  EXPECT_NE(poses_.back().initial_pose_id, 78);
}

/// A robot that drove until its pose was known, with a folder for the pose memory.
class PoseMemoryTest : public LocalizerNodeTest {
 protected:
  PoseMemoryTest() : folder_(std::filesystem::path(::testing::TempDir()) / "localizer_memory") {
    std::filesystem::remove_all(folder_);
    config_ = config_of(building_);
    config_.state_dir = folder_.string();
    options_.seed = 1000;
    options_.clutter = 0;
    world_.emplace(building_.building, building_.walls, config_.robot, options_);
  }
  /// Drives with a localizer of its own until `seconds` are over; returns the poses it published.
  std::vector<pose_t> drive(double seconds, std::int64_t session = 1) {
    lcm::LCM lcm("memq://");
    LocalizerNode node(lcm, config_);
    poses_.clear();
    errors_.clear();
    lcm.subscribe(channels::kPose, &LocalizerNodeTest::on_pose, static_cast<LocalizerNodeTest*>(this));
    for (int i = 0; i < static_cast<int>(30.0 * seconds); ++i) {
      const auto output = world_->step();
      if (output.frame) {
        const fixture_detections_t message = to_message(*output.frame);
        lcm.publish(channels::kFixtureDetections, &message);
      }
      if (output.odometry) {
        odometry_t message = to_message(*output.odometry, ++sequence_);
        message.session = session;
        lcm.publish(channels::kOdometry, &message);
      }
      while (lcm.handleTimeout(0) > 0) {
      }
      while (errors_.size() < poses_.size()) {
        errors_.push_back(error(poses_[errors_.size()]));
      }
    }
    return poses_;
  }
  double distance_to_tracking(const std::vector<pose_t>& poses) const {
    for (const pose_t& pose : poses) {
      if (pose.state == pose_t::STATE_TRACKING) {
        return 1e-6 * static_cast<double>(pose.utime - poses.front().utime);
      }
    }
    return 1e9;
  }
  double error(const pose_t& pose) const { return std::hypot(pose.x - world_->truth().x, pose.y - world_->truth().y); }

  std::filesystem::path folder_;
  std::vector<double> errors_;  // [m] of each pose when it was published
  LocalizerConfig config_;
  testing::SyntheticOptions options_;
  std::optional<testing::SyntheticWorld> world_;
};

TEST_F(PoseMemoryTest, TakesUpTheLastPoseAfterARestartOnceAFixtureAgrees) {
  const double first = distance_to_tracking(drive(60.0));
  ASSERT_LT(first, 60.0);
  const auto poses = drive(15.0);
  EXPECT_EQ(poses.front().state, pose_t::STATE_AMBIGUOUS);  // not before a sighting
  EXPECT_LT(distance_to_tracking(poses), 0.5 * first);
  EXPECT_EQ(poses.back().state, pose_t::STATE_TRACKING);
  EXPECT_LT(error(poses.back()), 0.2);
}

TEST_F(PoseMemoryTest, IgnoresAPoseOfAnotherOdometrySession) {
  ASSERT_LT(distance_to_tracking(drive(60.0)), 60.0);
  const auto poses = drive(1.0, 2);
  EXPECT_EQ(poses.front().state, pose_t::STATE_LOST);
}

TEST_F(PoseMemoryTest, DropsAPoseThatTheFirstSightingContradicts) {
  ASSERT_LT(distance_to_tracking(drive(60.0)), 60.0);
  const Pose2 before = world_->truth();
  Pose2 elsewhere = world_->draw_free_pose();
  while (distance(before, elsewhere) < 3.0) {
    elsewhere = world_->draw_free_pose();
  }
  world_->kidnap(elsewhere);  // while the localizer is not running; the wheels stand still
  const std::vector<pose_t> poses = drive(30.0);
  EXPECT_LT(distance_to_tracking(poses), 30.0);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_TRUE(poses[i].state != pose_t::STATE_TRACKING || errors_[i] < 0.5) << i << ": " << errors_[i];
  }
}

TEST_F(PoseMemoryTest, RemembersAgainAfterTheClockWasSetBack) {
  lcm::LCM lcm("memq://");
  LocalizerNode node(lcm, config_);
  const auto run = [&](double seconds, std::int64_t set_back) {
    for (int i = 0; i < static_cast<int>(30.0 * seconds); ++i) {
      const auto output = world_->step();
      if (output.frame) {
        fixture_detections_t message = to_message(*output.frame);
        message.utime -= set_back;
        lcm.publish(channels::kFixtureDetections, &message);
      }
      if (output.odometry) {
        odometry_t message = to_message(*output.odometry, ++sequence_);
        message.utime -= set_back;
        lcm.publish(channels::kOdometry, &message);
      }
      while (lcm.handleTimeout(0) > 0) {
      }
    }
  };
  const std::filesystem::path file = folder_ / "localizer_pose.toml";
  run(60.0, 0);
  ASSERT_TRUE(std::filesystem::exists(file));
  run(1.0, 500'000'000);
  std::filesystem::remove(file);
  run(60.0, 500'000'000);
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(PoseMemoryTest, SurvivesADamagedMemory) {
  ASSERT_LT(distance_to_tracking(drive(60.0)), 60.0);
  std::ofstream(folder_ / "localizer_pose.toml") << "building = \"two";
  EXPECT_EQ(drive(1.0).front().state, pose_t::STATE_LOST);
}

TEST_F(PoseMemoryTest, KeepsAPoseInDoubtForFiveSeconds) {
  building_.building.name = "the \"old\" house\\annexe";  // any name that a file may give
  PoseMemory memory(folder_, building_.building);
  LocalizerEstimate estimate;
  estimate.belief.pose = {3.0, 2.0, 0.5};
  estimate.state = LocalizerState::kTracking;
  memory.remember({10'000'000, 1, {1.0, 0.0, 0.0}}, estimate);
  estimate.state = LocalizerState::kAmbiguous;
  memory.remember({15'000'000, 1, {2.0, 0.0, 0.0}}, estimate);
  const OdometryReading ahead{16'000'000, 1, {2.0, 0.0, 0.0}};
  PoseMemory of_the_next_run(folder_, building_.building);
  const auto recalled = of_the_next_run.recall(ahead);
  ASSERT_TRUE(recalled);
  EXPECT_LT(distance(recalled->pose, Pose2{3.0, 2.0, 0.5} * Pose2{1.0, 0.0, 0.0}), 1e-6);
  EXPECT_FALSE(of_the_next_run.recall(ahead)) << "once";
  EXPECT_FALSE(PoseMemory(folder_, {}).recall(ahead)) << "in another building";
  memory.remember({15'100'000, 1, {2.0, 0.0, 0.0}}, estimate);
  EXPECT_FALSE(memory.load());
}

TEST_F(PoseMemoryTest, IsNoneWhereTheFileIsCutAnywhere) {
  const PoseMemory memory(folder_, building_.building);
  RememberedPose pose;
  pose.building = "two";
  pose.belief.covariance = 1e-12 * Eigen::Matrix3d::Identity();
  ASSERT_TRUE(memory.save(pose));
  ASSERT_TRUE(memory.load());
  // the last byte ends the last line, which says everything
  for (auto size = std::filesystem::file_size(folder_ / "localizer_pose.toml") - 1; size-- > 0;) {
    std::filesystem::resize_file(folder_ / "localizer_pose.toml", size);
    ASSERT_FALSE(memory.load()) << size;
  }
}

TEST_F(LocalizerNodeTest, WeighsAGuessAgainstTheTrackedPoseAndKeepsWhatIsSeen) {
  testing::SyntheticOptions options;
  options.seed = 1000;
  options.clutter = 0;
  testing::SyntheticWorld world(building_.building, building_.walls, config_of(building_).robot, options);
  bool is_told = false;
  bool was_suspected = false;
  double worst = 0.0;
  for (int i = 0; i < 30 * 120; ++i) {
    const auto output = world.step();
    if (output.frame) {
      const fixture_detections_t message = to_message(*output.frame);
      lcm_.publish(channels::kFixtureDetections, &message);
    }
    if (output.odometry) {
      const odometry_t message = to_message(*output.odometry, i);
      lcm_.publish(channels::kOdometry, &message);
    }
    handle_all();
    if (!output.odometry) {
      continue;
    }
    const pose_t& pose = poses_.back();
    if (!is_told && i > 30 * 80 && pose.state == pose_t::STATE_TRACKING) {
      initial_pose_t guess{};
      guess.utime = 1'000'000;
      guess.id = 5;
      guess.x = world.truth().x > 4.0 ? world.truth().x - 2.0 : world.truth().x + 2.0;
      guess.y = world.truth().y;
      guess.theta = world.truth().theta;
      guess.covariance[0] = guess.covariance[4] = guess.covariance[8] = 0.01;
      lcm_.publish(channels::kInitialPose, &guess);
      is_told = true;
    } else if (is_told) {
      was_suspected = was_suspected || pose.state == pose_t::STATE_AMBIGUOUS;
      if (pose.state == pose_t::STATE_TRACKING) {
        worst = std::max(worst, std::hypot(pose.x - world.truth().x, pose.y - world.truth().y));
      }
    }
  }
  ASSERT_TRUE(is_told);
  EXPECT_TRUE(was_suspected);
  EXPECT_EQ(poses_.back().initial_pose_id, 5);
  EXPECT_EQ(poses_.back().state, pose_t::STATE_TRACKING);
  EXPECT_LT(worst, 0.25);
}

TEST_F(LocalizerNodeTest, LeavesTrackingWhenItIsPushedWithItsMotorsOff) {
  const FixtureMap map(building_.building.fixtures);
  testing::SyntheticOptions options;
  options.seed = 1000;
  options.clutter = 0;
  testing::SyntheticWorld world(building_.building, building_.walls, config_of(building_).robot, options);
  SightingFrame last;
  Pose2 odometry;
  std::int64_t utime = 0;
  int i = 0;
  for (; i < 30 * 120; ++i) {
    const auto output = world.step();
    if (output.frame) {
      last = *output.frame;
      const fixture_detections_t message = to_message(last);
      lcm_.publish(channels::kFixtureDetections, &message);
    }
    if (output.odometry) {
      const odometry_t message = to_message(*output.odometry, i);
      odometry = output.odometry->odom_from_robot;
      utime = message.utime;
      lcm_.publish(channels::kOdometry, &message);
    }
    handle_all();
    if (i > 30 * 80 && output.odometry && poses_.back().state == pose_t::STATE_TRACKING && !last.sightings.empty() &&
        last.sightings.front().length > 1.1) {
      break;
    }
  }
  ASSERT_LT(i, 30 * 120) << "never tracked with a whole fixture in view";
  robot_status_t status{};
  status.utime = utime;
  status.connected = 1;
  status.motors_enabled = 0;
  lcm_.publish(channels::kRobotStatus, &status);
  // a hand moves the robot by 20 cm: the wheels tell nothing of it, the fixture in view does
  last.sightings.front().robot_from_fixture.x += 0.20;
  last.sightings.resize(1);
  bool left = false;
  for (int k = 1; k <= 10; ++k) {
    last.utime = utime + 100'000 * k - 20'000;
    const fixture_detections_t seen = to_message(last);
    lcm_.publish(channels::kFixtureDetections, &seen);
    const odometry_t message = to_message({utime + 100'000 * k, 1, odometry, 0.0, 0.0}, ++i);
    lcm_.publish(channels::kOdometry, &message);
    handle_all();
    left = left || poses_.back().state != pose_t::STATE_TRACKING;
  }
  EXPECT_TRUE(left);
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
