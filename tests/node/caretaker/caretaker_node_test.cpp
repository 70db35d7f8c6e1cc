#include "services/caretaker/caretaker_node.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/channels.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::SizeIs;

constexpr std::int64_t kStart = 1'000'000'000;  // [us]

class CaretakerNodeTest : public testing::Test {
 protected:
  CaretakerNodeTest() {
    robot_.name = "robot";
    robot_.camera.mounting.z = 0.3;
    building_.name = "hall";
    Fixture fixture;
    fixture.id = 5;
    fixture.world_from_fixture = {2.0, 0.0, 0.0};
    building_.fixtures.push_back(fixture);
  }

  void publish_pose(std::int64_t utime, double x, double sigma = 0.02, int state = pose_t::STATE_TRACKING) {
    pose_t message{};
    message.utime = utime;
    message.session = 1;
    message.state = static_cast<std::int8_t>(state);
    message.x = x;
    message.linear = 0.5;
    message.covariance[0] = message.covariance[4] = sigma * sigma;
    message.covariance[8] = 1e-4;
    lcm_.publish(channels::kPose, &message);
    lcm_.handleTimeout(0);
  }

  void publish_detections(std::int64_t utime, double fixture_x_in_robot, double exposure_us = 8000.0) {
    fixture_detections_t message{};
    message.utime = utime;
    message.exposure_us = exposure_us;
    message.median_grey = 80.0;
    message.count = 1;
    message.detections.resize(1);
    fixture_detection_t& detection = message.detections[0];
    detection.state = fixture_detection_t::STATE_LIT;
    detection.has_theta = true;
    detection.x = fixture_x_in_robot;
    detection.covariance[0] = detection.covariance[4] = detection.covariance[8] = 1e-4;
    detection.length = 1.2;
    detection.width = 0.3;
    detection.near_end_visible = detection.far_end_visible = true;
    lcm_.publish(channels::kFixtureDetections, &message);
    lcm_.handleTimeout(0);
  }

  void pass_below(double sigma = 0.02, int state = pose_t::STATE_TRACKING) {
    for (int i = 0; i < 60; ++i) {
      const double x = 0.5 + 0.05 * i;
      publish_detections(kStart + i * 100'000, 2.0 - x);
      publish_pose(kStart + i * 100'000, x, sigma, state);
    }
  }

  TemporaryFolder folder_;
  lcm::LCM lcm_{"memq://"};
  RobotDescription robot_;
  Building building_;
  std::filesystem::path file_ = ledger_file(folder_.path(), "robot");
};

TEST_F(CaretakerNodeTest, KeepsAVisitInItsFile) {
  {
    CaretakerNode node(lcm_, robot_, building_, file_);
    pass_below();
    node.finish();
    EXPECT_FALSE(node.health().degraded);
  }
  const LampLedger ledger = load_ledger(file_, "hall");
  ASSERT_THAT(ledger.visits(5), SizeIs(1));
  EXPECT_EQ(was_burning(ledger.visits(5)[0]), true);
  CaretakerNode next(lcm_, robot_, building_, file_);  // goes on where it left off
  EXPECT_EQ(next.ledger().size(), 1U);
}

TEST_F(CaretakerNodeTest, NoLampFlickersThatIsSeenInTurnWithPicturesForLamps) {
  CaretakerNode node(lcm_, robot_, building_, "");
  constexpr double kOutOfView = 50.0;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 + 0.05 * i;
    const bool is_for_lamps = i / 3 % 2 == 1;
    publish_detections(kStart + i * 100'000, is_for_lamps ? kOutOfView : 2.0 - x, is_for_lamps ? 560.0 : 8000.0);
    publish_pose(kStart + i * 100'000, x, 0.02, pose_t::STATE_TRACKING);
  }
  node.finish();
  ASSERT_THAT(node.ledger().visits(5), SizeIs(1));
  EXPECT_EQ(node.ledger().visits(5)[0].changes, 0);
  EXPECT_EQ(was_burning(node.ledger().visits(5)[0]), true);
}

TEST_F(CaretakerNodeTest, BelievesNoPoseThatIsNotSure) {
  CaretakerNode node(lcm_, robot_, building_, "");
  pass_below(0.5);
  pass_below(0.02, pose_t::STATE_AMBIGUOUS);
  node.finish();
  EXPECT_EQ(node.ledger().size(), 0U);
}

TEST_F(CaretakerNodeTest, DropsWhatMakesNoSense) {
  CaretakerNode node(lcm_, robot_, building_, "");
  publish_pose(kStart, std::numeric_limits<double>::quiet_NaN());
  fixture_detections_t message{};
  message.utime = kStart;
  message.median_grey = std::numeric_limits<double>::infinity();
  lcm_.publish(channels::kFixtureDetections, &message);
  lcm_.handleTimeout(0);
  EXPECT_EQ(node.health().dropped_inputs, 2);
}

TEST_F(CaretakerNodeTest, SaysWhenItCannotWrite) {
  write_whole_file(folder_.path() / "robot", "a file where the folder ought to be");
  CaretakerNode node(lcm_, robot_, building_, "");
  CaretakerNode blocked(lcm_, robot_, building_, file_);
  pass_below();
  blocked.finish();
  EXPECT_TRUE(blocked.health().degraded);
  EXPECT_FALSE(blocked.health().reason.empty());
}

TEST_F(CaretakerNodeTest, RefusesADamagedLedger) {
  std::filesystem::create_directories(file_.parent_path());
  write_whole_file(file_, "{");
  EXPECT_THROW(CaretakerNode(lcm_, robot_, building_, file_), std::runtime_error);
}

}  // namespace
}  // namespace luminav
