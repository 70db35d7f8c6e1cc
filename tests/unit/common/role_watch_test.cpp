#include "services/common/process/role_watch.hpp"

#include <gtest/gtest.h>

#include <map>

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

node_status_t status(const std::string& process, const std::string& host, std::int64_t instance) {
  node_status_t message{};
  message.process = process;
  message.host = host;
  message.robot = "p3dx";
  message.instance = instance;
  return message;
}

TEST(RoleWatch, NamesTwoControllersThatAreHeardInTurn) {
  RoleWatch watch("p3dx");
  for (std::int64_t now = 10 * kSecond; now < 13 * kSecond; now += kSecond) {
    watch.hear(status("controller", "robot", 1), now);
    watch.hear(status("controller", "desk", 2), now + kSecond / 2);
  }
  EXPECT_EQ(watch.conflict(13 * kSecond), "two controllers on this network: desk, robot");
  EXPECT_EQ(watch.conflict_of("controller", 13 * kSecond), "two controllers on this network: desk, robot");
  EXPECT_EQ(watch.conflict_of("localizer", 13 * kSecond), "");
}

TEST(RoleWatch, NamesTwoOfEachThatOnlyOneMayPlay) {
  const std::map<std::string, std::string> several = {
      {"p3dx", "drivers"},         {"create2", "drivers"},     {"camera", "cameras"},   {"detector", "detectors"},
      {"localizer", "localizers"}, {"mapper", "mappers"},      {"planner", "planners"}, {"controller", "controllers"},
      {"jobs", "job services"},    {"simulator", "simulators"}};
  for (const auto& [process, name] : several) {
    RoleWatch watch("p3dx");
    for (const std::int64_t instance : {1, 2, 1}) {
      watch.hear(status(process, "robot", instance), 10 * kSecond);
    }
    EXPECT_EQ(watch.conflict(11 * kSecond), "two " + name + " on this network, both on robot");
  }
}

TEST(RoleWatch, SaysSoWhenBothAreOnOneMachine) {
  RoleWatch watch("p3dx");
  for (const std::int64_t instance : {1, 2, 1}) {
    watch.hear(status("p3dx", "robot", instance), 10 * kSecond);
  }
  EXPECT_EQ(watch.conflict(11 * kSecond), "two drivers on this network, both on robot");
}

TEST(RoleWatch, ForgetsTheSecondOneThreeSecondsAfterItsLastWord) {
  RoleWatch watch("p3dx");
  for (const std::int64_t instance : {1, 2, 1}) {
    watch.hear(status("controller", "robot", instance), 10 * kSecond);
  }
  for (std::int64_t now = 11 * kSecond; now <= 14 * kSecond; now += kSecond) {
    EXPECT_EQ(watch.conflict(now).empty(), now >= 13 * kSecond) << now;
    watch.hear(status("controller", "robot", 1), now);
  }
}

TEST(RoleWatch, TakesARestartForNoSecondProcess) {
  RoleWatch watch("p3dx");
  std::int64_t now = 10 * kSecond;
  for (std::int64_t instance = 1; instance < 20; ++instance) {
    for (int i = 0; i < 3; ++i) {
      watch.hear(status("controller", "robot", instance), now += kSecond / 10);
      EXPECT_EQ(watch.conflict(now), "");
    }
  }
}

TEST(RoleWatch, MindsNeitherOtherRobotsNorWhatMayRunTwice) {
  RoleWatch watch("p3dx");
  for (int i = 0; i < 3; ++i) {
    for (const std::int64_t instance : {1, 2}) {
      for (const char* process : {"viewer", "caretaker", "deputy"}) {
        watch.hear(status(process, "desk", instance), 10 * kSecond);
      }
      node_status_t other = status("controller", "desk", instance);
      other.robot = "another";
      watch.hear(other, 10 * kSecond);
    }
  }
  EXPECT_EQ(watch.conflict(10 * kSecond), "");
}

}  // namespace
}  // namespace luminav
