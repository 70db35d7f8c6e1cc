#include "services/localizer/model/observation_model.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

RobotDescription robot_with_camera_at(double height) {
  RobotDescription robot;
  robot.camera.mounting.z = height;
  return robot;
}

TEST(ObservationModel, SeesNothingOfAFixtureBeyondItsReach) {
  const ObservationModel model({}, {}, robot_with_camera_at(0.3), {});
  const Fixture fixture;
  for (int i = 0; i < 36; ++i) {
    const Pose2 turned{0.0, 0.0, radians(10.0 * i)};
    for (const double across : {0.0, 0.5 * kPi}) {
      const Pose2 at_its_end = turned * Pose2{model.reach(), 0.0, across};
      EXPECT_EQ(model.view.visible_share(at_its_end, fixture, 0.0), 0.0) << 10 * i;
    }
  }
  EXPECT_GT(model.view.visible_share({model.reach() - 1.5, 0.0, 0.0}, fixture, 0.0), 0.0);
}

TEST(ObservationModel, KeepsTheCameraSomewhatBelowTheCeiling) {
  EXPECT_DOUBLE_EQ(ObservationModel({}, {}, robot_with_camera_at(0.3), {}).height_above_camera(), 2.5);
  EXPECT_DOUBLE_EQ(ObservationModel({}, {}, robot_with_camera_at(2.79), {}).height_above_camera(), 0.2);
}

}  // namespace
}  // namespace luminav
