#include "drivers/simulator/world/dock_contact.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

const Pose2 kPose{2.0, 1.0, 0.5};

Dock dock(double contact) {
  Dock result;
  result.pose = kPose;
  result.contact = contact;
  return result;
}

TEST(DockContact, MeetsWhenTheRobotStandsThereAndPartsWhenItLeaves) {
  DockContact contact(dock(1.0), 1);
  contact.step(kPose, false, false);
  EXPECT_FALSE(contact.has_met()) << "still coming";
  contact.step(kPose, true, false);
  EXPECT_TRUE(contact.has_met());
  contact.step(kPose, false, false);
  EXPECT_TRUE(contact.has_met());
  contact.step({2.1, 1.0, 0.5}, true, false);
  EXPECT_FALSE(contact.has_met());
  contact.step({2.0, 1.0, 0.7}, true, false);
  EXPECT_FALSE(contact.has_met());
  contact.step(kPose, true, true);
  EXPECT_FALSE(contact.has_met()) << "it hangs in somebody's hands";
}

TEST(DockContact, IsDrawnOnceEachTimeTheRobotComes) {
  DockContact contact(dock(0.5), 1);
  int met = 0;
  for (int i = 0; i < 1000; ++i) {
    contact.step(kPose, true, false);
    const bool has_met = contact.has_met();
    met += has_met ? 1 : 0;
    contact.step(kPose, true, false);
    ASSERT_EQ(contact.has_met(), has_met);
    contact.step({}, true, false);
  }
  EXPECT_NEAR(met, 500, 48);  // 3 sigma
}

TEST(DockContact, IsNeverWithoutADock) {
  DockContact contact(std::nullopt, 1);
  contact.step({}, true, false);
  EXPECT_FALSE(contact.has_met());
}

}  // namespace
}  // namespace luminav
