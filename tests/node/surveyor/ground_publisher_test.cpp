#include "services/surveyor/live/ground_publisher.hpp"

#include <gtest/gtest.h>

#include <luminav/grid_tile_t.hpp>
#include <luminav/pose_t.hpp>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

class GroundPublisherTest : public testing::Test {
 protected:
  GroundPublisherTest() {
    subscriber_.on(channels::kPose, &GroundPublisherTest::on_pose, this);
    subscriber_.on(channels::kGridTile, &GroundPublisherTest::on_tile, this);
  }
  void on_pose(const pose_t& pose) { pose_ = pose; }
  void on_tile(const grid_tile_t&) { ++tiles_; }

  void drive(std::int64_t utime, std::int64_t session) {
    const OdometryReading reading{utime, session, {1e-6 * static_cast<double>(utime), 0.0, 0.0}, 0.0, 0.0};
    ground_.add(reading);
    publisher_.publish(reading, ground_, is_exploring_);
    while (lcm_.handleTimeout(0) > 0) {
    }
  }

  static SurveyModel model() {
    SurveyModel model;
    model.robot = read_robot(LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml");
    return model;
  }

  lcm::LCM lcm_{"memq://"};
  SurveyModel model_ = model();
  LiveGround ground_{model_};
  GroundPublisher publisher_{lcm_};
  pose_t pose_{};
  int tiles_ = 0;
  bool is_exploring_ = true;
  Subscriber subscriber_{lcm_};
};

TEST_F(GroundPublisherTest, TellsThePoseWithAnErrorThatGrowsWithTheWay) {
  drive(1'000'000, 1);
  EXPECT_EQ(pose_.state, pose_t::STATE_TRACKING);
  const double before = pose_.covariance[0];
  drive(3'000'000, 1);
  EXPECT_NEAR(pose_.x, 2.0, 1e-9);
  EXPECT_GT(pose_.covariance[0], before);
}

TEST_F(GroundPublisherTest, IsLostOnceOdometryBeganAnew) {
  drive(1'000'000, 1);
  drive(2'000'000, 2);
  EXPECT_EQ(pose_.state, pose_t::STATE_LOST);
}

TEST_F(GroundPublisherTest, TellsNoPoseWhileAPersonDrives) {
  is_exploring_ = false;
  drive(1'000'000, 1);
  EXPECT_EQ(pose_.utime, 0);
  EXPECT_GT(tiles_, 0);
}

TEST_F(GroundPublisherTest, SendsTheTilesThatAreAskedFor) {
  drive(1'000'000, 1);
  tiles_ = 0;
  EXPECT_TRUE(publisher_.take({}));
  drive(1'100'000, 1);
  EXPECT_GT(tiles_, 10);
}

}  // namespace
}  // namespace luminav
