#include "tests/replay/log_reading/picture_trace.hpp"

#include <gmock/gmock.h>

#include <luminav/fixture_detections_t.hpp>
#include <luminav/pose_t.hpp>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kTaken = 1'000'000'000'000;  // [us]

/// A log of one picture after another, written by what the logger would hear.
class PictureTraceTest : public testing::Test {
 protected:
  void hear_picture(std::int64_t taken, std::int64_t at) {
    camera_image_t image{};
    image.utime = taken;
    image.height = 480;
    image.exposure_us = 8'000.0;
    trace_.add({at, channels::kCameraImage, encoded(image)});
  }
  void hear_detections(std::int64_t taken, std::int64_t at) {
    fixture_detections_t detections{};
    detections.utime = taken;
    trace_.add({at, channels::kFixtureDetections, encoded(detections)});
  }
  void hear_pose(std::int64_t picture, std::int64_t at, std::int8_t state = pose_t::STATE_TRACKING) {
    pose_t pose{};
    pose.utime = at;
    pose.state = state;
    pose.fixture_utime = picture;
    trace_.add({at, channels::kPose, encoded(pose)});
  }
  void hear_command(double angular, std::int64_t at) { hear_command(angular, at, at); }
  void hear_command(double angular, std::int64_t at, std::int64_t tick) {
    velocity_command_t command{};
    command.utime = tick;
    command.angular_z = angular;
    trace_.add({at, channels::kVelocityCommand, encoded(command)});
  }
  [[nodiscard]] std::vector<double> seconds_of(const std::string& name) const {
    for (const PictureTrace::Stage& stage : trace_.stages()) {
      if (stage.name == name) {
        return stage.seconds;
      }
    }
    return {};
  }

  PictureTrace trace_{[](const camera_image_t& image) { return image.utime + 57'000; }};
};

TEST_F(PictureTraceTest, SplitsThePathOfAPictureIntoItsStages) {
  hear_command(0.1, kTaken);
  hear_picture(kTaken, kTaken + 60'000);
  hear_detections(kTaken, kTaken + 64'000);
  hear_pose(kTaken, kTaken + 65'000);
  hear_command(0.2, kTaken + 67'000);
  EXPECT_THAT(seconds_of("taken_to_arrival"), ElementsAre(DoubleNear(0.057, 1e-9)));
  EXPECT_THAT(seconds_of("arrival_to_picture"), ElementsAre(DoubleNear(0.003, 1e-9)));
  EXPECT_THAT(seconds_of("picture_to_detections"), ElementsAre(DoubleNear(0.004, 1e-9)));
  EXPECT_THAT(seconds_of("detections_to_pose"), ElementsAre(DoubleNear(0.001, 1e-9)));
  EXPECT_THAT(seconds_of("pose_to_command"), ElementsAre(DoubleNear(0.002, 1e-9)));
  EXPECT_THAT(seconds_of("image_to_command"), ElementsAre(DoubleNear(0.067, 1e-9)));
  EXPECT_THAT(seconds_of("arrival_to_command"), ElementsAre(DoubleNear(0.010, 1e-9)));
}

TEST_F(PictureTraceTest, ACommandThatIsRepeatedUsedNothingNew) {
  hear_command(0.1, kTaken);
  hear_detections(kTaken, kTaken + 64'000);
  hear_pose(kTaken, kTaken + 65'000);
  hear_command(0.1, kTaken + 70'000);
  EXPECT_THAT(seconds_of("pose_to_command"), testing::IsEmpty());
  hear_command(0.2, kTaken + 90'000);
  EXPECT_THAT(seconds_of("pose_to_command"), ElementsAre(DoubleNear(0.025, 1e-9)));
}

TEST_F(PictureTraceTest, ASecondCommandForATickAnswersThePose) {
  hear_command(0.1, kTaken + 60'000);
  hear_detections(kTaken, kTaken + 64'000);
  hear_pose(kTaken, kTaken + 65'000);
  hear_command(0.1, kTaken + 67'000, kTaken + 60'000);  // it turns as fast as it may, before and after
  EXPECT_THAT(seconds_of("pose_to_command"), ElementsAre(DoubleNear(0.002, 1e-9)));
}

TEST_F(PictureTraceTest, ARobotThatStandsUsesNoPicture) {
  hear_command(0.0, kTaken);
  hear_detections(kTaken, kTaken + 64'000);
  hear_pose(kTaken, kTaken + 65'000);
  hear_command(0.0, kTaken + 70'000);
  hear_command(0.2, kTaken + 3'000'000);  // a goal came
  EXPECT_THAT(seconds_of("pose_to_command"), testing::IsEmpty());
}

TEST_F(PictureTraceTest, CountsAPictureOnceAndOnlyForAPoseThatIsKnown) {
  hear_detections(kTaken, kTaken + 64'000);
  hear_pose(kTaken, kTaken + 65'000, pose_t::STATE_LOST);
  EXPECT_THAT(seconds_of("detections_to_pose"), testing::IsEmpty());
  hear_pose(kTaken + 20'000, kTaken + 66'000);  // the localizer adds the camera's time offset
  hear_pose(kTaken + 20'000, kTaken + 166'000);
  EXPECT_THAT(seconds_of("detections_to_pose"), ElementsAre(DoubleNear(0.002, 1e-9)));
}

TEST_F(PictureTraceTest, SaysMedianAndNinetyNinePercent) {
  EXPECT_EQ(trace_.text(), "");
  for (int i = 0; i <= 100; ++i) {
    const std::int64_t taken = kTaken + 66'667 * i;
    hear_picture(taken, taken + 50'000 + 100 * i);
    hear_detections(taken, taken + 60'000 + 100 * i);
  }
  EXPECT_THAT(trace_.text(), HasSubstr("image_to_detections           101     65.0     69.9"));
}

}  // namespace
}  // namespace luminav
