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

TEST(ControllerConfig, RefusesUnknownKeysAndSpeedsAboveTheRobots) {
  std::ifstream shipped(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
  const std::string text((std::istreambuf_iterator<char>(shipped)), std::istreambuf_iterator<char>());
  const auto file =
      std::filesystem::temp_directory_path() / ("controller_config_" + std::to_string(::getpid()) + ".toml");
  for (const char* table : {"\n[controller]\nmargn = 0.1\n", "\n[controller]\nmaximum_linear = 2.0\n"}) {
    std::ofstream(file) << text << table;
    EXPECT_THROW(read_controller_config(file), ConfigurationError);
  }
  std::ofstream(file) << text << "\n[controller]\nwander_speed = 0.2\n";
  EXPECT_DOUBLE_EQ(read_controller_config(file).wander.speed, 0.2);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace luminav
