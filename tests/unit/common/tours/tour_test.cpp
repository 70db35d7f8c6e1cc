#include "services/common/tours/tour.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(Tour, ReadsTimesOfDay) {
  EXPECT_EQ(read_time_of_day("09:30"), 9 * 3600 + 30 * 60);
  EXPECT_EQ(read_time_of_day("0:05"), 300);
  for (const char* wrong : {"", "9", "24:00", "9:60", "-1:00", "9:3x", "09:30:00", "1e1:00"}) {
    EXPECT_FALSE(read_time_of_day(wrong)) << wrong;
  }
}

TEST(Tour, ReadsDays) {
  EXPECT_EQ(read_days("Mo-Fr"), (Weekdays{true, true, true, true, true, false, false}));
  EXPECT_EQ(read_days("Sa, Su"), (Weekdays{false, false, false, false, false, true, true}));
  EXPECT_EQ(read_days("Sa-Mo"), (Weekdays{true, false, false, false, false, true, true}));
  for (const char* wrong : {"", "Mon", "Mo-", "Mo-Xx", "Mo Fr"}) {
    EXPECT_FALSE(read_days(wrong)) << wrong;
  }
}

TEST(Tour, WritesDaysAsPeopleDo) {
  EXPECT_EQ(days_text(*read_days("Fr,Mo,Tu,We,Th")), "Mo-Fr");
  EXPECT_EQ(days_text(*read_days("Sa,Su")), "Sa,Su");
  EXPECT_EQ(days_text(*read_days("Mo,We-Fr,Su")), "Mo,We-Fr,Su");
}

TEST(Tour, ReadsWhatItWrites) {
  for (unsigned set = 1; set < 128; ++set) {
    Weekdays days{};
    for (std::size_t day = 0; day < days.size(); ++day) {
      days[day] = (set >> day & 1U) != 0;
    }
    EXPECT_EQ(read_days(days_text(days)), days) << days_text(days);
  }
  for (const int second : {0, 60, 34'200, 86'340}) {
    EXPECT_EQ(read_time_of_day(time_of_day_text(second)), second);
  }
}

}  // namespace
}  // namespace luminav
