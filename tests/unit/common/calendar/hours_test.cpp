#include "services/common/calendar/hours.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr int kMonday = 0;
constexpr int kFriday = 4;
constexpr int kSaturday = 5;
constexpr int kSunday = 6;

LocalTime at(int weekday, int hour, int minute = 0, int second = 0) {
  return {100 + weekday, weekday, 3600 * hour + 60 * minute + second};
}

Hours hours_of(const std::string& span, const std::string& days = "Mo-Su") {
  const auto [begin, end] = *read_span(span);
  return {begin, end, *read_days(days)};
}

Hours whole_days(const std::string& days) {
  return {.days = *read_days(days)};
}

TEST(Hours, ReadsATimeOfDay) {
  EXPECT_EQ(read_time_of_day("09:30"), 9 * 3600 + 30 * 60);
  EXPECT_EQ(read_time_of_day("0:05"), 300);
  for (const char* wrong : {"", "9", "9.30", "24:00", "9:60", "-1:00", "9:3x", "09:30:00", "1e1:00", ":30"}) {
    EXPECT_FALSE(read_time_of_day(wrong)) << wrong;
  }
}

TEST(Hours, ReadDaysAndSpansOfThem) {
  EXPECT_EQ(read_days("Mo-Fr"), (Days{true, true, true, true, true, false, false}));
  EXPECT_EQ(read_days("Sa, Su"), (Days{false, false, false, false, false, true, true}));
  EXPECT_EQ(read_days("Sa-Mo"), (Days{true, false, false, false, false, true, true}));
  for (const char* wrong : {"", "mo", "Mon", "Mo-", "Mo-Xx", "Mo Fr", "Mo;Tu"}) {
    EXPECT_FALSE(read_days(wrong)) << wrong;
  }
}

TEST(Hours, ReadTwoTimesOfDayThatDiffer) {
  EXPECT_EQ(read_span("08:00-12:30"), (std::pair(8 * 3600, 12 * 3600 + 1800)));
  EXPECT_EQ(read_span("22:00 - 06:00"), (std::pair(22 * 3600, 6 * 3600)));
  for (const char* wrong : {"", "8-12", "08:00", "25:00-26:00", "08:00-08:00", "08:00-12:00-14:00", "08:00–12:00"}) {
    EXPECT_FALSE(read_span(wrong)) << wrong;
  }
}

TEST(Hours, HoldAlwaysUnlessSaidOtherwise) {
  EXPECT_TRUE(are_always(Hours{}));
  EXPECT_TRUE(hold(Hours{}, at(kMonday, 0)));
  EXPECT_TRUE(hold(Hours{}, at(kSunday, 23, 59, 59)));
  EXPECT_EQ(end_of(Hours{}, at(kSunday, 23)), "");
  EXPECT_FALSE(are_always(whole_days("Mo-Sa")));
}

TEST(Hours, HoldFromTheFirstSecondToTheOneBeforeTheEnd) {
  const Hours school = hours_of("08:00-12:00", "Mo-Fr");
  EXPECT_FALSE(hold(school, at(kMonday, 7, 59, 59)));
  EXPECT_TRUE(hold(school, at(kMonday, 8)));
  EXPECT_TRUE(hold(school, at(kFriday, 11, 59, 59)));
  EXPECT_FALSE(hold(school, at(kFriday, 12)));
  EXPECT_FALSE(hold(school, at(kSaturday, 9)));
  EXPECT_EQ(end_of(school, at(kMonday, 9)), "12:00");
}

TEST(Hours, OverMidnightBelongToTheDayOnWhichTheyBegin) {
  const Hours night = hours_of("22:00-06:00", "Fr");
  EXPECT_FALSE(hold(night, at(kFriday, 5))) << "Thursday's night has no hours";
  EXPECT_TRUE(hold(night, at(kFriday, 22)));
  EXPECT_TRUE(hold(night, at(kSaturday, 5, 59, 59)));
  EXPECT_FALSE(hold(night, at(kSaturday, 6)));
  EXPECT_FALSE(hold(night, at(kSaturday, 23)));
  EXPECT_EQ(end_of(night, at(kFriday, 23)), "06:00");
  EXPECT_TRUE(hold(hours_of("22:00-06:00", "Su"), at(kMonday, 1))) << "over the end of the week";
}

TEST(Hours, OfWholeDaysEndAtTheMidnightAfterTheLastOfThem) {
  const Hours weekdays = whole_days("Mo-Fr");
  EXPECT_TRUE(hold(weekdays, at(kFriday, 23, 59, 59)));
  EXPECT_FALSE(hold(weekdays, at(kSaturday, 0)));
  EXPECT_EQ(end_of(weekdays, at(kFriday, 9)), "Sa 00:00");
  EXPECT_EQ(end_of(weekdays, at(kMonday, 9)), "Sa 00:00");
  EXPECT_EQ(end_of(whole_days("Fr-Mo"), at(kSaturday, 9)), "Tu 00:00");
}

TEST(Hours, MeetWhereBothHold) {
  EXPECT_TRUE(meet(Hours{}, hours_of("08:00-08:01", "Su")));
  EXPECT_FALSE(meet(hours_of("08:00-12:00"), hours_of("12:00-14:00")));
  EXPECT_FALSE(meet(hours_of("08:00-12:00", "Mo"), hours_of("08:00-12:00", "Tu")));
  EXPECT_TRUE(meet(hours_of("22:00-06:00", "Su"), hours_of("05:00-07:00", "Mo")));
}

TEST(Hours, AreWrittenAsTheyAreRead) {
  for (const char* span : {"08:00-12:00", "22:00-06:00", "18:30-00:00"}) {
    EXPECT_EQ(span_text(hours_of(span)), span);
  }
  for (const char* days : {"Mo", "Mo-Fr", "Sa,Su", "Mo,We-Fr,Su"}) {
    EXPECT_EQ(days_text(*read_days(days)), days);
  }
  EXPECT_EQ(days_text(*read_days("Sa-Mo")), "Mo,Sa,Su") << "the same days";
  EXPECT_EQ(text_of(hours_of("08:00-12:00", "Mo-Fr")), "Mo-Fr 08:00-12:00");
  EXPECT_EQ(text_of(hours_of("08:00-12:00")), "08:00-12:00");
  EXPECT_EQ(text_of(whole_days("Sa")), "Sa");
  EXPECT_EQ(text_of(Hours{}), "");
}

}  // namespace
}  // namespace luminav
