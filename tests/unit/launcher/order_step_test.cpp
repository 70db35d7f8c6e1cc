#include <gtest/gtest.h>

#include "services/launcher/deputy/managed_command.hpp"

namespace luminav::launcher {
namespace {

struct Case {
  bool running;
  int actual, desired;
  bool force_quit;
  OrderStep step;
};

TEST(OrderStep, FollowsProcmansRulesForRunIds) {
  const std::vector<Case> table = {
      // (a) stopped, another run, wanted
      {false, 0, 1, false, OrderStep::kStart},
      {false, 3, 4, false, OrderStep::kStart},
      {false, 3, 2, false, OrderStep::kStart},
      {false, 3, 0, false, OrderStep::kStart},
      // (b) running and not wanted, or wanted anew
      {true, 3, 3, true, OrderStep::kStop},
      {true, 3, 4, true, OrderStep::kStop},
      {true, 3, 0, true, OrderStep::kStop},
      {true, 3, 4, false, OrderStep::kStop},
      // (c) nothing to do
      {true, 3, 3, false, OrderStep::kNote},
      {true, 3, 0, false, OrderStep::kNote},
      {false, 3, 3, false, OrderStep::kNote},
      {false, 0, 0, false, OrderStep::kNote},
      {false, 3, 4, true, OrderStep::kNote},
      {false, 3, 3, true, OrderStep::kNote},
  };
  for (const Case& one : table) {
    EXPECT_EQ(step_for(one.running, one.actual, one.desired, one.force_quit), one.step)
        << one.running << " " << one.actual << " " << one.desired << " " << one.force_quit;
  }
}

}  // namespace
}  // namespace luminav::launcher
