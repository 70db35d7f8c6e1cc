#include "services/operator/system_snapshot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/process/channels.hpp"
#include "services/operator/goal_order.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

TEST(SystemSnapshot, IsEmptyUntilSomebodySpeaks) {
  lcm::LCM lcm("memq://");
  const SystemSnapshot snapshot(lcm);
  EXPECT_TRUE(snapshot.is_empty());
  node_status_t node{};
  node.utime = 1;
  node.process = "planner";
  lcm.publish(channels::kNodeStatus, &node);
  while (lcm.handleTimeout(0) > 0) {
  }
  EXPECT_FALSE(snapshot.is_empty());
}

TEST(SystemSnapshot, SaysWhatIsThereAndWhatIsMissing) {
  lcm::LCM lcm("memq://");
  const SystemSnapshot snapshot(lcm);
  robot_status_t robot{};
  robot.utime = 1;
  robot.robot = "p3dx";
  robot.connected = true;
  robot.motors_enabled = true;
  robot.battery_voltage = 12.64;
  lcm.publish(channels::kRobotStatus, &robot);
  navigation_status_t navigation{};
  navigation.utime = 1;
  navigation.state = navigation_status_t::STATE_WAITING;
  navigation.cause = "the door is shut";
  lcm.publish(channels::kNavigationStatus, &navigation);
  node_status_t node{};
  node.utime = 1;
  node.process = "mapper";
  node.state = node_status_t::STATE_DEGRADED;
  node.reason = "no pose";
  lcm.publish(channels::kNodeStatus, &node);
  while (lcm.handleTimeout(0) > 0) {
  }
  const std::string page = snapshot.page();
  EXPECT_THAT(page, HasSubstr("p3dx, 12.6 V, motors on"));
  EXPECT_THAT(page, HasSubstr("waiting: the door is shut"));
  EXPECT_THAT(page, HasSubstr("no word from the localizer"));
  EXPECT_THAT(page, HasSubstr("mapper       degraded"));
  EXPECT_THAT(page, HasSubstr("no pose"));
}

TEST(SystemSnapshot, ShowsTwoProcessesOfOneName) {
  lcm::LCM lcm("memq://");
  const SystemSnapshot snapshot(lcm);
  for (const std::int64_t instance : {1, 2, 1}) {
    node_status_t node{};
    node.utime = 1;
    node.process = "viewer";
    node.instance = instance;
    node.state = instance == 2 ? node_status_t::STATE_FAULT : node_status_t::STATE_READY;
    lcm.publish(channels::kNodeStatus, &node);
  }
  while (lcm.handleTimeout(0) > 0) {
  }
  EXPECT_THAT(snapshot.page(), HasSubstr("viewer       ready"));
  EXPECT_THAT(snapshot.page(), HasSubstr("viewer       fault"));
}

TEST(SystemSnapshot, NamesStatesItDoesNotKnow) {
  EXPECT_EQ(navigation_state_name(99), "state 99");
  EXPECT_EQ(pose_state_name(-1), "state -1");
}

}  // namespace
}  // namespace luminav
