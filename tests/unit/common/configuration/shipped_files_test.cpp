#include <gtest/gtest.h>

#include <filesystem>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_base.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

const std::filesystem::path kLaunch = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch";

TEST(ShippedFiles, EveryBuildingIsReadAndItsFixturesHangOverTheMap) {
  for (const auto& entry : std::filesystem::directory_iterator(kLaunch / "buildings")) {
    SCOPED_TRACE(entry.path());
    const Building building = read_building(entry.path() / "building.toml");
    EXPECT_FALSE(building.fixtures.empty());
    const PriorMap map = read_map(building.map_file);
    for (const Fixture& fixture : building.fixtures) {
      EXPECT_TRUE(map.geometry.contains(map.geometry.cell_at(fixture.world_from_fixture.position()))) << fixture.id;
    }
    for (const Place& place : building.places) {
      EXPECT_EQ(map.at(place.pose.position()), Prior::kFree) << place.name;
    }
  }
}

TEST(ShippedFiles, EveryRobotIsRead) {
  for (const auto& entry : std::filesystem::directory_iterator(kLaunch / "robots")) {
    SCOPED_TRACE(entry.path());
    const RobotDescription robot = read_robot(entry.path());
    if (read_robot_base(entry.path()) == "create2") {
      EXPECT_TRUE(robot.sonar.robot_from_sonar.empty());
      EXPECT_NEAR(robot.swept_radius(), robot.inscribed_radius(), 0.01) << "round";
      EXPECT_NEAR(robot.inscribed_radius(), 0.17, 1e-4);
      continue;
    }
    EXPECT_EQ(robot.sonar.robot_from_sonar.size(), 16U);
    // the rear corner swings farthest
    EXPECT_NEAR(robot.swept_radius(), std::hypot(0.301, 0.2125), 1e-9);
    EXPECT_NEAR(robot.inscribed_radius(), 0.21, 1e-9);
  }
}

TEST(BuildingFile, RefusesTwoFixturesOfOneId) {
  const TemporaryFolder folder;
  const std::string fixture = "[[fixture]]\nid = 1\nx = 0\ny = 0\nlength = 1.2\nwidth = 0.3\n";
  const auto file = folder.write("building.toml", "name = \"b\"\nceiling_height = 2.8\n" + fixture + fixture);
  EXPECT_THROW((void)read_building(file), ConfigurationError);
}

TEST(RobotFile, RefusesAFootprintTheWrongWayRound) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("r.toml", "name = \"r\"\nfootprint = [[0.2, 0.2], [0.2, -0.2], [-0.2, -0.2], [-0.2, 0.2]]\n");
  EXPECT_THROW((void)read_robot(file), ConfigurationError);
}

}  // namespace
}  // namespace luminav
