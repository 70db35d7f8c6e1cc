#include "services/common/calendar/local_time.hpp"

#include <gtest/gtest.h>

#include "tests/support/time_zone.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;                      // [us]
constexpr std::int64_t kWinterNoon = 1'769'860'800 * kSecond;    // Saturday 31 January 2026, 12:00 UTC
constexpr std::int64_t kBeforeSummer = 1'774'745'999 * kSecond;  // Sunday 29 March 2026, 00:59:59 UTC
constexpr const char* kBerlin = "CET-1CEST,M3.5.0,M10.5.0/3";

void expect(const LocalTime& time, int weekday, int hour, int minute, int second) {
  EXPECT_EQ(time.weekday, weekday);
  EXPECT_EQ(time.second, 3600 * hour + 60 * minute + second);
}

TEST(LocalTime, TellsWeekdayAndSecondInGreenwich) {
  expect(universal_time(0), 3, 0, 0, 0);
  expect(universal_time(-1), 2, 23, 59, 59);
  expect(universal_time(kWinterNoon + 999'999), 5, 12, 0, 0);
  EXPECT_EQ(universal_time(kWinterNoon + 12 * 3600 * kSecond).day, universal_time(kWinterNoon).day + 1);
}

TEST(LocalTime, GoesByTheTimeZoneAndItsSummer) {
  const TimeZone berlin(kBerlin);
  expect(local_time(kWinterNoon), 5, 13, 0, 0);
  expect(local_time(kBeforeSummer), 6, 1, 59, 59);
  expect(local_time(kBeforeSummer + kSecond), 6, 3, 0, 0);
  EXPECT_EQ(local_time(kWinterNoon + 11 * 3600 * kSecond).day, local_time(kWinterNoon).day + 1)
      << "midnight is an hour earlier than in Greenwich";
}

TEST(LocalTime, InGreenwichIsTheSameWhereverTheMachineStands) {
  const LocalTime there = universal_time(kWinterNoon);
  const TimeZone berlin(kBerlin);
  expect(universal_time(kWinterNoon), there.weekday, 12, 0, 0);
}

TEST(LocalTime, IsReckonedFromAnOffset) {
  expect(ahead_of_universal(*read_utc_offset("+0530"))(kWinterNoon), 5, 17, 30, 0);
  expect(ahead_of_universal(*read_utc_offset("-1300"))(kWinterNoon), 4, 23, 0, 0);
  EXPECT_EQ(read_utc_offset("+0000"), 0);
  for (const char* wrong : {"", "0100", "+100", "+01:00", "+1600", "+0160", "CET"}) {
    EXPECT_FALSE(read_utc_offset(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace luminav
