#include "drivers/simulator/world/injected_faults.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

SonarRing ring() {
  SonarRing result;
  result.robot_from_sonar.assign(3, Pose2{});
  result.maximum_range = 5.0;
  return result;
}

/// Lasts from 1 s to 3 s when it is started at 1 s.
ScenarioEvent event(EventKind kind, const std::string& device = "") {
  ScenarioEvent result;
  result.kind = kind;
  result.device = device;
  result.duration = 2.0;
  return result;
}

TEST(InjectedFaults, SlipForAWhile) {
  InjectedFaults faults(ring());
  ScenarioEvent slip = event(EventKind::kSlip);
  slip.factor = 0.5;
  EXPECT_EQ(faults.grip(0.5), 1.0);
  faults.start(slip, 1.0);
  EXPECT_EQ(faults.grip(2.9), 0.5);
  EXPECT_EQ(faults.grip(3.0), 1.0);
}

TEST(InjectedFaults, UnplugOneDeviceEach) {
  InjectedFaults faults(ring());
  faults.start(event(EventKind::kUnplug, "camera"), 1.0);
  EXPECT_TRUE(faults.is_camera_unplugged(2.0));
  EXPECT_FALSE(faults.is_serial_unplugged(2.0));
  faults.start(event(EventKind::kUnplug, "serial"), 2.0);
  EXPECT_FALSE(faults.is_camera_unplugged(3.5));
  EXPECT_TRUE(faults.is_serial_unplugged(3.5));
}

TEST(InjectedFaults, FreezeOneEncoder) {
  InjectedFaults faults(ring());
  faults.start(event(EventKind::kFreeze, "camera"), 1.0);
  EXPECT_EQ(faults.count(0, 0.1, 2.0), 0.1);
  EXPECT_EQ(faults.count(1, 0.1, 2.0), 0.1);
  faults.start(event(EventKind::kFreeze, "encoder_right"), 1.0);
  EXPECT_EQ(faults.count(0, 0.1, 2.0), 0.1);
  EXPECT_EQ(faults.count(1, 0.1, 2.0), 0.0);
  EXPECT_EQ(faults.count(1, 0.1, 3.0), 0.1);
}

TEST(InjectedFaults, DeafenAndStickTheDiscsTheyNameOrAll) {
  InjectedFaults faults(ring());
  EXPECT_EQ(faults.hear(1, 2.0, 0.5), 2.0);
  ScenarioEvent deafen = event(EventKind::kDeafen);
  deafen.discs = {0};
  faults.start(deafen, 1.0);
  faults.start(event(EventKind::kStick), 1.0);
  EXPECT_EQ(faults.hear(0, 1.0, 2.0), 5.0);
  EXPECT_EQ(faults.hear(1, 1.0, 2.0), 2.0);
  EXPECT_EQ(faults.hear(2, 1.0, 2.0), 5.0) << "it has heard nothing yet";
  for (const int disc : {0, 1, 2}) {
    EXPECT_EQ(faults.hear(disc, 1.0, 3.0), 1.0);
  }
}

}  // namespace
}  // namespace luminav
