#include "services/operator/goal_target.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

Building building() {
  Building result;
  result.name = "test";
  result.places = {{"workbench", {1.0, 2.0, 0.5}, true}, {"lift", {3.0, 4.0, 0.0}, false}};
  return result;
}

TEST(GoalTarget, ReadsNumbersOnlyWhereAllAreNumbers) {
  EXPECT_EQ(read_numbers({"4.2", "-1.5"}), (std::vector<double>{4.2, -1.5}));
  EXPECT_FALSE(read_numbers({"4.2", "x"}));
  EXPECT_FALSE(read_numbers({"4.2", "nan"}));
  EXPECT_FALSE(read_numbers({""}));
}

TEST(GoalTarget, TakesAPointWithOrWithoutHeading) {
  const goal_t plain = make_goal({"4.2", "-1.5"}, {});
  ASSERT_EQ(plain.count, 1);
  EXPECT_DOUBLE_EQ(plain.poses[0].x, 4.2);
  EXPECT_DOUBLE_EQ(plain.poses[0].y, -1.5);
  EXPECT_FALSE(plain.poses[0].has_theta);
  const goal_t turned = make_goal({"4.2", "-1.5", "4.0"}, {});
  EXPECT_TRUE(turned.poses[0].has_theta);
  EXPECT_NEAR(turned.poses[0].theta, 4.0 - 2.0 * kPi, 1e-12);
}

TEST(GoalTarget, TakesAPlaceWithItsHeadingIfItHasOne) {
  const goal_t bench = make_goal({"workbench"}, building());
  EXPECT_EQ(bench.poses[0].place, "workbench");
  EXPECT_TRUE(bench.poses[0].has_theta);
  EXPECT_DOUBLE_EQ(bench.poses[0].theta, 0.5);
  EXPECT_FALSE(make_goal({"lift"}, building()).poses[0].has_theta);
}

TEST(GoalTarget, NamesTheKnownPlacesWhenAPlaceIsUnknown) {
  try {
    make_goal({"cellar"}, building());
    FAIL() << "must throw";
  } catch (const ConfigurationError& error) {
    EXPECT_NE(std::string(error.what()).find("workbench, lift"), std::string::npos);
  }
}

TEST(GoalTarget, RefusesTooFewAndTooManyNumbers) {
  EXPECT_THROW(make_goal({"1"}, building()), ConfigurationError);
  EXPECT_THROW(make_goal({"1", "2", "3", "4"}, building()), ConfigurationError);
}

TEST(GoalTarget, TakesAHeadingInRadiansOrInDegrees) {
  EXPECT_NEAR(make_goal({"1", "2", "1.5"}, Building{}).poses.at(0).theta, 1.5, 1e-12);
  const goal_pose_t turned = make_goal({"1", "-2", "-90deg"}, Building{}).poses.at(0);
  EXPECT_NEAR(turned.theta, -1.5707963267948966, 1e-12);
  EXPECT_EQ(turned.y, -2.0);
  EXPECT_FALSE(read_point({"90deg", "1"}));
}

}  // namespace
}  // namespace luminav
