#include "tests/evaluation/start_resolvability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {
namespace {

const std::filesystem::path kLaunch = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch";

double way_from(const std::string& building, const Eigen::Vector2d& start) {
  return resolvable_way(read_building(kLaunch / "buildings" / building / "building.toml"),
                        read_robot(kLaunch / "robots/p3dx.toml").camera, start);
}

TEST(StartResolvability, IsSomeMetresInTheLaboratory) {
  const double way = way_from("laboratory", {14.0, 9.4});
  EXPECT_GT(way, 0.5);
  EXPECT_LT(way, 7.0);
}

TEST(StartResolvability, IsNeverGivenInTheSymmetricCorridor) {
  EXPECT_TRUE(std::isinf(way_from("symmetric-corridor", {6.0, 1.2})));
}

TEST(StartResolvability, IsNotKnownOutsideOfTheBuilding) {
  EXPECT_LT(way_from("laboratory", {-50.0, 9.4}), 0.0);
}

}  // namespace
}  // namespace luminav
