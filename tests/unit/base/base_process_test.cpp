#include "drivers/base/base_process.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

TEST(BaseOptions, OnlyEverLowerTheSpeedOfTheFile) {
  BaseOptions options;
  for (const auto& [asked, linear] : {std::pair{0.0, 0.5}, {0.2, 0.2}, {0.9, 0.5}}) {
    MotionLimits limits{.linear = 0.5, .linear_deceleration = 1.0};
    options.max_speed = asked;
    options.limit(limits);
    EXPECT_EQ(limits.linear, linear);
  }
  MotionLimits limits;
  options.max_speed = -0.1;
  EXPECT_THROW(options.limit(limits), ConfigurationError);
}

TEST(Guarding, GivesTheRobotTimeToBrakeAndTheGuardianToLeave) {
  const double brake_time = brake_time_of({.linear = 0.5, .linear_deceleration = 0.5});
  EXPECT_GT(brake_time, 1.0);
  EXPECT_GT(done_after_of({.silence = 0.3, .brake_time = brake_time}), 0.3 + brake_time);
}

TEST(OpenByConfiguration, RefusesWhatIsNoLine) {
  EXPECT_THROW(open_by_configuration("ttyUSB0", 9600), ConfigurationError);
  EXPECT_NO_THROW(open_by_configuration("/dev/does-not-exist", 9600)) << "it may be plugged in later";
}

}  // namespace
}  // namespace luminav
