#include "tests/evaluation/runs/whole_robot.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <luminav/velocity_command_t.hpp>
#include <map>
#include <string>

#include "services/common/configuration/building_file.hpp"
#include "tests/evaluation/runs/scenario_run.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/time_zone.hpp"

namespace luminav {
namespace {

const std::string kFolder = std::string(LUMINAV_SOURCE_DIR) + "/tests/system/";

/// Digests every message of a handle: channel and bytes, in order (FNV-1a).
class Digest {
 public:
  explicit Digest(lcm::LCM& lcm) { lcm.subscribe(".*", &Digest::on_message, this); }
  [[nodiscard]] std::uint64_t value() const { return value_; }
  [[nodiscard]] const std::map<std::string, int>& counts() const { return counts_; }

 private:
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    ++counts_[channel];
    for (const char letter : channel) {
      add(static_cast<std::uint8_t>(letter));
    }
    const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
    for (std::uint32_t i = 0; i < buffer->data_size; ++i) {
      add(bytes[i]);
    }
  }
  void add(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001b3ULL; }
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
  std::map<std::string, int> counts_;
};

struct Outcome {
  std::uint64_t digest = 0;
  std::map<std::string, int> counts;
};

Outcome run(std::uint64_t seed, double seconds) {
  Scenario scenario = read_scenario(std::string(LUMINAV_SOURCE_DIR) + "/launch/scenarios/laboratory.toml");
  scenario.seed = seed;
  WholeRobot robot(scenario, {});
  const Digest digest(robot.lcm());
  for (int i = 0; i < static_cast<int>(seconds * 100.0); ++i) {
    robot.step();
  }
  return {digest.value(), digest.counts()};
}

TEST(WholeRobot, GivesTheSameBytesForTheSameSeed) {
  const Outcome first = run(7, 12.0);
  EXPECT_EQ(first.digest, run(7, 12.0).digest);
  EXPECT_NE(first.digest, run(8, 12.0).digest);
}

TEST(WholeRobot, PublishesEveryChannelAtItsRate) {
  const Outcome outcome = run(7, 12.0);
  const auto count = [&](const char* channel) {
    return outcome.counts.count(channel) > 0 ? outcome.counts.at(channel) : 0;
  };
  EXPECT_NEAR(count("SIM_TRUTH"), 1200, 5);
  EXPECT_NEAR(count("ROBOT_STATUS"), 600, 20);
  EXPECT_NEAR(count("ODOMETRY"), 115, 10);
  EXPECT_GE(count("POSE"), count("ODOMETRY") - 3);
  EXPECT_LE(count("POSE"), count("ODOMETRY") + count("FIXTURE_DETECTIONS"));
  EXPECT_NEAR(count("SONAR"), count("ODOMETRY"), 3);
  EXPECT_NEAR(count("CAMERA_IMAGE"), 178, 8);
  EXPECT_NEAR(count("FIXTURE_DETECTIONS"), count("CAMERA_IMAGE"), 2);
  EXPECT_GT(count("GRID_TILE"), 4);
  EXPECT_GT(count("VELOCITY_COMMAND"), 400);
}

TEST(WholeRobot, DrivesToANearGoalWithoutContact) {
  Scenario scenario = read_scenario(kFolder + "near_goal.toml");
  const RunReport report = run_scenario(scenario, {});
  EXPECT_TRUE(report.passed) << to_text(report);
  EXPECT_EQ(report.confident_wrong_s, 0.0);
  ASSERT_EQ(report.goals.size(), 1U);
  EXPECT_LT(report.goals[0].error_m, 0.25);
}

TEST(WholeRobot, KeepsTheHoursOfZonesOnEveryMachine) {
  const TemporaryFolder folder;
  Scenario scenario = read_scenario(kFolder + "near_goal.toml");
  Building building = read_building(scenario.building_file);
  building.zones = {{.name = "yard", .polygon = {{8.0, 5.8}, {9.2, 5.8}, {9.2, 7.0}, {8.0, 7.0}}}};
  building.zones[0].hours = {8 * 3600, 9 * 3600, *read_days("Mo")};
  scenario.building_file = folder.path() / "building.toml";
  write_building(scenario.building_file, building);
  for (const char* zone : {"UTC0", "CET-1", "EST5"}) {
    const TimeZone here(zone);
    const RunReport report = run_scenario(scenario, {});
    ASSERT_EQ(report.goals.size(), 1U);
    EXPECT_TRUE(report.goals[0].refused) << zone;
    EXPECT_EQ(report.goals[0].cause, "(8.6, 6.4) lies in yard, which is a keep-out zone until 09:00") << zone;
  }
}

TEST(WholeRobot, ArrivesThoughEveryServiceDiesOnTheWay) {
  Scenario scenario = read_scenario(kFolder + "near_goal.toml");
  double at = 6.0;
  for (const char* process : {"detector", "localizer", "mapper", "controller", "camera", "p3dx"}) {
    ScenarioEvent event;
    event.kind = EventKind::kKill;
    event.at = at;
    event.process = process;
    scenario.events.push_back(event);
    at += 1.5;
  }
  scenario.duration = 200.0;
  const RunReport report = run_scenario(scenario, {});
  EXPECT_TRUE(report.passed) << to_text(report);
}

}  // namespace
}  // namespace luminav
