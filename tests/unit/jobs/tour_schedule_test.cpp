#include "services/jobs/tour_schedule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr int kHalfPastNine = 9 * 3600 + 30 * 60;

std::vector<StoredTour> one_tour() {
  return {{.name = "morning", .stops = {{}}, .at = kHalfPastNine, .days = *read_days("Mo-Fr")}};
}

bool is_due(const LocalTime& now, const std::map<std::string, int>& started = {}) {
  return !due_tours(one_tour(), now, started).empty();
}

TEST(TourSchedule, StartsATourAtItsTimeOnItsDays) {
  EXPECT_FALSE(is_due({7, 0, kHalfPastNine - 1}));
  EXPECT_TRUE(is_due({7, 0, kHalfPastNine}));
  EXPECT_TRUE(is_due({7, 0, kHalfPastNine + 60})) << "a start of the service may fall on it";
  EXPECT_FALSE(is_due({12, 5, kHalfPastNine})) << "Saturday";
}

TEST(TourSchedule, DoesNotMakeUpForWhatLiesInThePast) {
  EXPECT_FALSE(is_due({7, 0, kHalfPastNine + 600}));
}

TEST(TourSchedule, StartsNothingASecondTimeWhenAClockIsSetBack) {
  EXPECT_FALSE(is_due({7, 0, kHalfPastNine + 1}, {{"morning", 7}}));
  EXPECT_TRUE(is_due({8, 1, kHalfPastNine + 1}, {{"morning", 7}}));
}

}  // namespace
}  // namespace luminav
