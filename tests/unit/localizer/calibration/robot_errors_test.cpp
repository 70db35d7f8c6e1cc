#include "services/localizer/robot_errors.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace luminav {
namespace {

RobotErrors read(const std::string& text) {
  const std::string file = testing::TempDir() + "/errors.toml";
  std::ofstream(file) << text;
  return read_robot_errors(TomlTable::load(file).table("localizer"));
}

TEST(RobotErrors, AreThoseOfAnUncalibratedRobotWhereTheFileIsSilent) {
  const RobotErrors read_errors = read("");
  EXPECT_TRUE(read_errors.wheels.is_none());
  EXPECT_DOUBLE_EQ(read_errors.errors.wheel_scale, ErrorParams{}.wheel_scale);
}

TEST(RobotErrors, AreWhatACalibrationWrote) {
  const RobotErrors read_errors = read(
      "[localizer.wheels]\nscale = 0.01\n[localizer.errors]\nwheel_scale = 0.001\n[localizer.rules]\nignored = 1\n");
  EXPECT_DOUBLE_EQ(read_errors.wheels.scale, 0.01);
  EXPECT_DOUBLE_EQ(read_errors.errors.wheel_scale, 0.001);
}

TEST(RobotErrors, AreReadStrictly) {
  EXPECT_THROW((void)read("[localizer.wheels]\nscales = 0.01\n"), ConfigurationError);
  EXPECT_THROW((void)read("[localizer.errors]\nwheel_scale = 3.0\n"), ConfigurationError);
}

}  // namespace
}  // namespace luminav
