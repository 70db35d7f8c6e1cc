#include "tests/evaluation/judge/start_resolvability.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "services/common/configuration/toml_table.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

const std::filesystem::path kLaunch = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch";

double distance_from(const std::string& building, const Eigen::Vector2d& start) {
  StartResolvability resolvability;
  return resolvability.distance(kLaunch / "buildings" / building / "building.toml", kLaunch / "robots/p3dx.toml",
                                start);
}

TEST(StartResolvability, IsSomeMetresInTheLaboratory) {
  const double distance = distance_from("laboratory", {14.0, 9.4});
  EXPECT_GT(distance, 0.5);
  EXPECT_LT(distance, 7.0);
}

TEST(StartResolvability, IsNeverGivenInTheSymmetricCorridor) {
  EXPECT_TRUE(std::isinf(distance_from("symmetric-corridor", {6.0, 1.2})));
}

TEST(StartResolvability, IsNotKnownOutsideOfTheBuilding) {
  EXPECT_LT(distance_from("laboratory", {-50.0, 9.4}), 0.0);
}

TEST(StartResolvability, AnswersEachBuildingOfMany) {
  StartResolvability resolvability;
  const auto ask = [&](const std::string& building, const Eigen::Vector2d& start) {
    return resolvability.distance(kLaunch / "buildings" / building / "building.toml", kLaunch / "robots/p3dx.toml",
                                  start);
  };
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(ask("laboratory", {14.0, 9.4}), distance_from("laboratory", {14.0, 9.4}));
    EXPECT_TRUE(std::isinf(ask("symmetric-corridor", {6.0, 1.2})));
  }
  EXPECT_THROW((void)ask("no-such-building", {1.0, 1.0}), ConfigurationError);
}

// Two hundred drawn missions have a building's file each, of eight ceilings: audited one by one they took more time
// than they ran, and 40 MB each.
TEST(StartResolvability, AuditsACeilingOnceHoweverManyFilesDescribeIt) {
  const TemporaryFolder folder;
  std::ifstream shipped(kLaunch / "buildings/laboratory/building.toml");
  std::string text((std::istreambuf_iterator<char>(shipped)), {});
  const std::string map = "map = \"map.yaml\"";
  ASSERT_NE(text.find(map), std::string::npos);
  text.replace(text.find(map), map.size(),
               fmt::format("map = \"{}\"", (kLaunch / "buildings/laboratory/map.yaml").string()));
  const std::filesystem::path zoned =
      folder.write("building.toml", text +
                                        "\n[[zone]]\nname = \"stairs\"\nkind = \"keep-out\"\n"
                                        "polygon = [[13.0, 9.0], [14.0, 9.0], [14.0, 10.0]]\n");
  StartResolvability resolvability;
  const std::filesystem::path robot = kLaunch / "robots/p3dx.toml";
  const Eigen::Vector2d start{14.0, 9.4};
  EXPECT_EQ(resolvability.distance(zoned, robot, start),
            resolvability.distance(kLaunch / "buildings/laboratory/building.toml", robot, start));
  EXPECT_EQ(resolvability.audits(), 1U);
}

}  // namespace
}  // namespace luminav
