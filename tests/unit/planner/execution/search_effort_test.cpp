#include "services/planner/execution/search_effort.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(SearchEffort, IsInVainAfterDrivingManyTimesTheFirstPath) {
  GoalParams params;
  params.search_ratio = 2.0;
  params.search_length = 1.0;
  SearchEffort search(params);
  search.drive_to({0.0, 0.0});
  search.drive_to({100.0, 0.0});
  EXPECT_FALSE(search.is_in_vain()) << "no path is known yet";
  search.reset();
  search.expect(5.0);
  search.expect(50.0);  // only the first one counts
  search.drive_to({0.0, 0.0});
  search.drive_to({11.0, 0.0});
  EXPECT_FALSE(search.is_in_vain());
  search.drive_to({11.0, 0.1});
  EXPECT_TRUE(search.is_in_vain());
}

TEST(SearchEffort, DoesNotCountWhereTheRobotWasCarried) {
  SearchEffort search({});
  search.drive_to({0.0, 0.0});
  search.interrupt();
  search.drive_to({30.0, 0.0});
  search.drive_to({31.0, 0.0});
  EXPECT_EQ(search.driven(), 1.0);
}

}  // namespace
}  // namespace luminav
