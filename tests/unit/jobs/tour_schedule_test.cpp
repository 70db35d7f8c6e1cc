#include "services/jobs/tour_schedule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

using Days = std::array<bool, 7>;
constexpr int kHalfPastNine = 9 * 3600 + 30 * 60;

std::vector<StoredTour> one_tour() {
  return {{.name = "morning", .stops = {{}}, .at = kHalfPastNine, .days = *read_days("Mo-Fr")}};
}

bool is_due(const LocalTime& now, const std::map<std::string, int>& started = {}) {
  return !due_tours(one_tour(), now, started).empty();
}

TEST(TourSchedule, ReadsTimesOfDay) {
  EXPECT_EQ(read_time_of_day("09:30"), kHalfPastNine);
  EXPECT_EQ(read_time_of_day("0:05"), 300);
  for (const char* wrong : {"", "9", "24:00", "9:60", "-1:00", "9:3x", "09:30:00", "1e1:00"}) {
    EXPECT_FALSE(read_time_of_day(wrong)) << wrong;
  }
}

TEST(TourSchedule, ReadsDays) {
  EXPECT_EQ(read_days("Mo-Fr"), (Days{true, true, true, true, true, false, false}));
  EXPECT_EQ(read_days("Sa, Su"), (Days{false, false, false, false, false, true, true}));
  EXPECT_EQ(read_days("Sa-Mo"), (Days{true, false, false, false, false, true, true}));
  for (const char* wrong : {"", "Mon", "Mo-", "Mo-Xx", "Mo Fr"}) {
    EXPECT_FALSE(read_days(wrong)) << wrong;
  }
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
