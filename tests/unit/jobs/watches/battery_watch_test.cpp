#include "services/jobs/watches/battery_watch.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

void hold(BatteryWatch& battery, double voltage, double seconds, double distance = 0.0) {
  for (double t = 0.0; t < seconds; t += 0.2) {
    battery.update(voltage, distance, 0.2);
  }
}

TEST(BatteryWatch, IsLowBelowItsLimitAndNotAgainUntilItIsCharged) {
  BatteryWatch battery(BatteryParams{});
  hold(battery, 12.2, 60.0);
  EXPECT_FALSE(battery.is_low());
  hold(battery, 11.5, 200.0);
  EXPECT_TRUE(battery.is_low());
  hold(battery, 12.2, 600.0);
  EXPECT_TRUE(battery.is_low()) << "it recovers when the robot stands, but is as empty as before";
  hold(battery, 13.2, 200.0);
  EXPECT_FALSE(battery.is_low());
}

TEST(BatteryWatch, LetsTheChargerSayWhenItIsCharged) {
  BatteryWatch battery(BatteryParams{});
  hold(battery, 11.5, 200.0);
  for (int i = 0; i < 1000; ++i) {
    battery.update(13.4, 0.0, 1.0, Charger::kCharges);
  }
  EXPECT_TRUE(battery.is_low()) << "the charger lifts the voltage at once";
  battery.update(14.2, 0.0, 1.0, Charger::kHasCharged);
  EXPECT_FALSE(battery.is_low());
}

TEST(BatteryWatch, TakesNoSagForAnEmptyBattery) {
  BatteryWatch battery(BatteryParams{});
  hold(battery, 12.2, 60.0);
  hold(battery, 11.2, 2.0);
  EXPECT_FALSE(battery.is_low());
}

TEST(BatteryWatch, LeavesEarlierFromAfar) {
  BatteryWatch near(BatteryParams{});
  BatteryWatch far(BatteryParams{});
  hold(near, 11.8, 60.0, 5.0);
  hold(far, 11.8, 60.0, 60.0);
  EXPECT_FALSE(near.is_low());
  EXPECT_TRUE(far.is_low());
}

TEST(BatteryWatch, JudgesNothingByAnUnknownVoltage) {
  BatteryWatch battery(BatteryParams{});
  hold(battery, 0.0, 600.0, 100.0);
  EXPECT_FALSE(battery.is_low());
}

}  // namespace
}  // namespace luminav
