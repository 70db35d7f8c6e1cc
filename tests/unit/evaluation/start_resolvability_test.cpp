#include "tests/evaluation/judge/start_resolvability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/configuration/toml_table.hpp"

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

}  // namespace
}  // namespace luminav
