#include "services/common/building/zone_timetable.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kHour = 3'600'000'000;  // [us] from the epoch, a Thursday's midnight

const Zone kStairs = {.name = "stairs"};
const Zone kYard = {.name = "yard", .hours = {8 * 3600, 12 * 3600, *read_days("Mo-Fr")}};

std::vector<std::string> names(const ZoneTimetable& zones) {
  std::vector<std::string> result;
  for (const Zone& zone : zones.in_force()) {
    result.push_back(zone.name + until_of(zone));
  }
  return result;
}

TEST(ZoneTimetable, HasAllZonesInForceUntilItIsToldTheTime) {
  ZoneTimetable zones({kYard, kStairs}, universal_time);
  EXPECT_THAT(names(zones), ElementsAre("yard", "stairs"));
  EXPECT_TRUE(zones.tell(7 * kHour));
  EXPECT_THAT(names(zones), ElementsAre("stairs"));
  EXPECT_FALSE(zones.is_in_force(0));
  EXPECT_TRUE(zones.is_in_force(1));
}

TEST(ZoneTimetable, TellsWhenAZoneBeginsAndEndsAndUntilWhenItHolds) {
  ZoneTimetable zones({kYard, kStairs}, universal_time);
  EXPECT_TRUE(zones.tell(8 * kHour - 1));
  EXPECT_TRUE(zones.tell(8 * kHour));
  EXPECT_THAT(names(zones), ElementsAre("yard until 12:00", "stairs"));
  EXPECT_FALSE(zones.tell(8 * kHour + 1)) << "the same second";
  EXPECT_FALSE(zones.tell(12 * kHour - 1));
  EXPECT_TRUE(zones.tell(12 * kHour));
  EXPECT_THAT(names(zones), ElementsAre("stairs"));
}

TEST(ZoneTimetable, GoesBackWithAClockThatIsSetBack) {
  ZoneTimetable zones({kYard}, universal_time);
  EXPECT_TRUE(zones.tell(12 * kHour));
  EXPECT_TRUE(zones.tell(9 * kHour));
  EXPECT_THAT(names(zones), ElementsAre("yard until 12:00"));
}

TEST(ZoneTimetable, TakesNewZonesByTheTimeThatItWasToldLast) {
  ZoneTimetable zones({kStairs}, universal_time);
  EXPECT_FALSE(zones.tell(7 * kHour)) << "without hours nothing begins or ends";
  zones.set({kYard});
  EXPECT_THAT(names(zones), IsEmpty());
  EXPECT_EQ(zones.all().size(), 1U);
  EXPECT_TRUE(zones.tell(9 * kHour));
}

TEST(ZoneTimetable, AsksForNoTimeOfDayWhereNoZoneHasHours) {
  ZoneTimetable zones({kStairs}, [](std::int64_t) -> LocalTime { throw std::logic_error("asked"); });
  EXPECT_FALSE(zones.tell(9 * kHour));
  EXPECT_THAT(names(zones), ElementsAre("stairs"));
}

}  // namespace
}  // namespace luminav
