#include "drivers/p3dx/p3dx_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace luminav {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml";

std::string error_of(const std::string& table) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "p3dx_config_test.toml";
  std::ofstream(file) << "name = \"r\"\nfootprint = [[1, -1], [1, 1], [-1, 1], [-1, -1]]\n[p3dx]\n" << table;
  try {
    read_p3dx_config(file);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

TEST(P3dxConfig, ReadsTheShippedRobot) {
  const P3dxConfig config = read_p3dx_config(kShipped);
  EXPECT_EQ(config.robot.sonar.robot_from_sonar.size(), 16U);
  EXPECT_EQ(config.device, "tcp:127.0.0.1:8101");
  EXPECT_TRUE(config.enable_motors_at_start);
}

TEST(P3dxConfig, NamesTheKeyThatIsWrong) {
  using testing::HasSubstr;
  EXPECT_EQ(error_of("baud = 38400\nfast_baud = 115200\nenable_motors = \"on_request\""), "");
  EXPECT_THAT(error_of("baud = 12345"), HasSubstr("115200"));
  EXPECT_THAT(error_of("device = \"ttyUSB0\""), HasSubstr("tcp:HOST:PORT"));
  EXPECT_THAT(error_of("enable_motors = \"never\""), HasSubstr("on_request"));
  EXPECT_EQ(error_of("supervised = 0"), "");
  EXPECT_EQ(error_of("supervised = 5"), "");
  EXPECT_THAT(error_of("supervised = 1"), HasSubstr("2 to 600"));
  EXPECT_THAT(error_of("motors = true"), HasSubstr("motors"));
  EXPECT_THAT(error_of("command_timeout = 9.0"), HasSubstr("command_timeout"));
}

}  // namespace
}  // namespace luminav
