#include "services/controller/inputs/pose_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace luminav {
namespace {

using testing::HasSubstr;
using Verdict = PoseInput::Verdict;

constexpr std::int64_t kNow = 1'000'000'000;  // [us]
constexpr std::int64_t kSession = 5;

class PoseInputTest : public testing::Test {
 protected:
  Verdict drive(std::int64_t utime, double x, std::int64_t session = kSession) {
    odometry_t message{};
    message.utime = utime;
    message.session = session;
    message.x = x;
    return input_.take(message, why_);
  }
  static pose_t pose(std::int64_t utime, std::int8_t state = pose_t::STATE_TRACKING) {
    pose_t message{};
    message.utime = utime;
    message.session = kSession;
    message.state = state;
    message.x = 10.0;
    message.floor = "ground";
    message.reason = "it was carried";
    return message;
  }
  Verdict say(const pose_t& message) { return input_.take(message, why_); }
  Verdict guess(std::int64_t utime) {
    hypotheses_t message{};
    message.utime = utime;
    message.count = 2;
    message.x = {3.0F, 7.0F};
    message.y = message.theta = {0.0F, 0.0F};
    message.sigma = {0.1F, 0.1F};
    message.weight = {0.6F, 0.4F};
    return input_.take(message, why_);
  }

  PoseInput input_;
  std::string why_;
};

TEST_F(PoseInputTest, PlacesTheOdometryInTheWorldWhileThePoseIsTrusted) {
  EXPECT_THAT(*input_.reason_not_to_trust(), HasSubstr("not spoken"));
  drive(kNow, 1.0);
  EXPECT_EQ(say(pose(kNow)), Verdict::kNews);
  EXPECT_FALSE(input_.reason_not_to_trust());
  ASSERT_TRUE(input_.world_from_odom());
  EXPECT_NEAR(input_.world_from_odom()->x, 9.0, 1e-9);
  EXPECT_TRUE(input_.is_on_another_floor("first"));
  EXPECT_FALSE(input_.is_on_another_floor("ground"));
}

TEST_F(PoseInputTest, DistrustsAPoseThatGrowsOldOrIsLost) {
  drive(kNow, 1.0);
  say(pose(kNow));
  drive(kNow + 250'000, 1.1);
  EXPECT_FALSE(input_.reason_not_to_trust());
  drive(kNow + 400'000, 1.1);
  EXPECT_EQ(*input_.reason_not_to_trust(), "the pose is 0.4 s old");
  EXPECT_FALSE(input_.world_from_odom());
  EXPECT_EQ(say(pose(kNow + 400'000, pose_t::STATE_LOST)), Verdict::kNews);
  EXPECT_EQ(*input_.reason_not_to_trust(), "the pose is not known: it was carried");
  EXPECT_FALSE(input_.is_on_another_floor("first")) << "nobody knows on which";
}

TEST_F(PoseInputTest, TellsACorrectedPoseFromOneThatGoesOn) {
  drive(kNow, 1.0);
  say(pose(kNow));
  EXPECT_EQ(say(pose(kNow + 100'000)), Verdict::kTaken);
  pose_t corrected = pose(kNow + 100'000);
  corrected.fixture_utime = kNow + 50'000;
  EXPECT_EQ(say(corrected), Verdict::kNews);
}

TEST_F(PoseInputTest, RefusesWhatIsOldAheadOrImpossible) {
  drive(kNow, 1.0);
  EXPECT_EQ(drive(kNow - 100'000, 1.0), Verdict::kRefused);
  EXPECT_EQ(why_, "ODOMETRY: older than the last");
  EXPECT_EQ(drive(kNow + 100'000, std::numeric_limits<double>::infinity()), Verdict::kRefused);
  EXPECT_EQ(say(pose(kNow + 3'600'000'000)), Verdict::kRefused);
  EXPECT_EQ(why_, "POSE: ahead of the odometry");
  EXPECT_THAT(*input_.reason_not_to_trust(), HasSubstr("not spoken"));
}

TEST_F(PoseInputTest, GoesOnWithTheLastPoseOfASilentLocalizerAndWithGuessesOfALostOne) {
  drive(kNow, 0.0);
  EXPECT_EQ(guess(kNow), Verdict::kTaken);
  EXPECT_EQ(input_.possible().size(), 2U);
  say(pose(kNow));
  input_.remember(*input_.world_from_odom());
  drive(kNow + 1'000'000, 0.5);
  ASSERT_EQ(input_.possible().size(), 1U) << "silent since a second";
  EXPECT_NEAR(input_.possible()[0].world_from_odom.x, 10.0, 1e-9);
  say(pose(kNow + 1'000'000, pose_t::STATE_LOST));
  EXPECT_EQ(input_.possible().size(), 2U);
}

TEST_F(PoseInputTest, ForgetsPlacesWhenTheOdometryStartsAnew) {
  drive(kNow, 0.0);
  guess(kNow);
  say(pose(kNow));
  input_.remember(*input_.world_from_odom());
  EXPECT_EQ(drive(kNow + 100'000, 0.0, kSession + 1), Verdict::kNewSession);
  EXPECT_TRUE(input_.possible().empty());
  EXPECT_THAT(*input_.reason_not_to_trust(), HasSubstr("not spoken"));
  EXPECT_EQ(input_.odometry().began(), kNow + 100'000);
}

}  // namespace
}  // namespace luminav
