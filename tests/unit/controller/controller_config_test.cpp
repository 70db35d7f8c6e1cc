#include "services/controller/controller_config.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

TEST(ControllerConfig, ReadsTheShippedRobot) {
  const ControllerConfig config = read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
  EXPECT_DOUBLE_EQ(config.follower.speed.linear, config.robot.limits.linear);
  EXPECT_EQ(config.robot.sonar.robot_from_sonar.size(), 16U);
  EXPECT_LT(config.wander.speed, config.follower.speed.linear);
}

/// The shipped robot with lines of its own in table [controller].
ControllerConfig config_with(const std::string& lines) {
  std::ifstream shipped(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
  const std::string text((std::istreambuf_iterator<char>(shipped)), std::istreambuf_iterator<char>());
  const auto file =
      std::filesystem::temp_directory_path() / ("controller_config_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << text << "\n[controller]\n" << lines << "\n";
  try {
    const ControllerConfig config = read_controller_config(file);
    std::filesystem::remove(file);
    return config;
  } catch (...) {
    std::filesystem::remove(file);
    throw;
  }
}

TEST(ControllerConfig, RefusesUnknownKeysAndSpeedsAboveTheRobots) {
  EXPECT_THROW(config_with("margn = 0.1"), ConfigurationError);
  EXPECT_THROW(config_with("maximum_linear = 2.0"), ConfigurationError);
  EXPECT_DOUBLE_EQ(config_with("wander_speed = 0.2").wander.speed, 0.2);
}

TEST(ControllerConfig, SteersByTheMarginOfTheFile) {
  const ControllerConfig narrow = config_with("margin = 0.02");
  const ControllerConfig wide = config_with("margin = 0.12");
  EXPECT_NEAR(wide.follower.heading.free_heading.half_width - narrow.follower.heading.free_heading.half_width, 0.1,
              1e-9);
  EXPECT_NEAR(wide.wander.heading.free_heading.half_width - narrow.wander.heading.free_heading.half_width, 0.1, 1e-9);
}

TEST(ControllerConfig, SearchesNoFasterThanTheFileAllows) {
  const ControllerConfig config = config_with("maximum_linear = 0.2\nmaximum_angular = 0.4");
  EXPECT_DOUBLE_EQ(config.wander.speed, 0.2);
  EXPECT_DOUBLE_EQ(config.wander.angular, 0.4);
  EXPECT_THROW(config_with("maximum_linear = 0.2\nwander_speed = 0.3"), ConfigurationError);
}

}  // namespace
}  // namespace luminav
