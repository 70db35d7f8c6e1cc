#include "drivers/simulator/world/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const fs::path& folder() {
  static const fs::path path = [] {
    fs::path made = fs::path(testing::TempDir()) / "luminav_scenarios";
    fs::create_directories(made);
    write_text(made / "building.toml",
               "name = \"test\"\nceiling_height = 2.5\n"
               "[[fixture]]\nid = 3\nx = 1.0\ny = 1.0\ntheta = 0.0\nlength = 1.2\nwidth = 0.3\n"
               "[[fixture]]\nid = 4\nx = 3.0\ny = 1.0\ntheta = 0.0\nlength = 1.2\nwidth = 0.3\n"
               "[[door]]\nid = 7\nx = 2.0\ny = 2.0\ntheta = 0.0\nwidth = 0.9\n"
               "[[place]]\nname = \"desk\"\nx = 4.0\ny = 5.0\ntheta = 1.5\n"
               "[[place]]\nname = \"door\"\nx = 6.0\ny = 7.0\n");
    write_text(made / "robot.toml", "base = \"create2\"\n");
    return made;
  }();
  return path;
}

const std::string kHead = "building = \"building.toml\"\nrobot = \"robot.toml\"\n";

Scenario read(const std::string& text) {
  write_text(folder() / "case.toml", kHead + text);
  return read_scenario(folder() / "case.toml");
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ScenarioFile, HasDefaultsForAllButBuildingAndRobot) {
  const Scenario scenario = read("");
  EXPECT_EQ(scenario.name, "case");
  EXPECT_EQ(scenario.building_file, folder() / "building.toml");
  EXPECT_EQ(scenario.robot_file, folder() / "robot.toml");
  EXPECT_EQ(scenario.base, "create2");
  EXPECT_EQ(scenario.seed, 1U);
  EXPECT_FALSE(scenario.start.has_value());
  EXPECT_FALSE(scenario.start_known);
  EXPECT_TRUE(scenario.goals.empty());
}

TEST(ScenarioFile, DrawsTheWorldRoundAnotherBuildingWhereAsked) {
  EXPECT_EQ(read("").true_building_file, folder() / "building.toml");
  write_text(folder() / "true.toml",
             "name = \"true\"\nceiling_height = 2.5\n"
             "[[fixture]]\nid = 9\nx = 1.0\ny = 1.0\ntheta = 0.0\nlength = 1.2\nwidth = 0.3\n");
  const Scenario scenario =
      read("[truth]\nbuilding = \"true.toml\"\n[lighting]\noff = [9]\n[[goal]]\nplace = \"desk\"\n");
  EXPECT_EQ(scenario.true_building_file, folder() / "true.toml");
  EXPECT_EQ(scenario.building_file, folder() / "building.toml");
  EXPECT_THAT(error_of("[truth]\nbuilding = \"nowhere.toml\"\n"), HasSubstr("no such file"));
  EXPECT_THAT(error_of("[truth]\nbuildings = \"true.toml\"\n"), HasSubstr("buildings"));
}

TEST(ScenarioFile, IsReadWhole) {
  const Scenario scenario = read(R"(
seed = 12
duration = 120.0
[start]
x = 1.0
y = 2.0
theta = 4.0
known = true
[lighting]
daylight = 0.2
off = [3]
half = [4]
off_ratio = 0.25
[world]
calibrated = true
wheel_scale = 0.02
floor_tilt = 0.004
[[obstacle]]
x = 3.0
y = 1.5
theta = 0.5
length = 0.6
width = 0.3
kind = "glass"
[[obstacle]]
kind = "legs"
[[hole]]
x = 5.0
y = 2.0
length = 1.2
[[person]]
waypoints = [[1.0, 1.0], [6.0, 1.0], [6.0, 4.0]]
speed = 1.1
[[person]]
[[goal]]
x = 2.0
y = 3.0
[[goal]]
place = "desk"
tolerance = 0.1
[[goal]]
place = "door"
theta = 0.7
expect = "refused"
[[drive]]
v = 0.3
w = -0.2
for = 4.0
)");
  EXPECT_EQ(scenario.seed, 12U);
  EXPECT_EQ(scenario.duration, 120.0);
  ASSERT_TRUE(scenario.start.has_value());
  EXPECT_NEAR(scenario.start->theta, 4.0 - 2.0 * kPi, 1e-12);
  EXPECT_TRUE(scenario.start_known);
  EXPECT_EQ(scenario.lighting.daylight, 0.2);
  EXPECT_THAT(scenario.lighting.off, ElementsAre(3));
  EXPECT_THAT(scenario.lighting.half, ElementsAre(4));
  EXPECT_EQ(scenario.lighting.off_ratio, 0.25);
  EXPECT_TRUE(scenario.world.calibrated);
  EXPECT_EQ(scenario.world.wheel_scale, 0.02);
  EXPECT_EQ(scenario.world.wheel_ratio, 0.005);
  ASSERT_EQ(scenario.obstacles.size(), 2U);
  EXPECT_EQ(scenario.obstacles[0].kind, ObstacleKind::kGlass);
  EXPECT_EQ(scenario.obstacles[0].world_from_obstacle->y, 1.5);
  EXPECT_EQ(scenario.obstacles[1].kind, ObstacleKind::kLegs);
  EXPECT_FALSE(scenario.obstacles[1].world_from_obstacle.has_value());
  ASSERT_EQ(scenario.holes.size(), 1U);
  EXPECT_EQ(scenario.holes[0].pose.x, 5.0);
  EXPECT_EQ(scenario.holes[0].length, 1.2);
  EXPECT_EQ(scenario.holes[0].width, 1.0);
  ASSERT_EQ(scenario.people.size(), 2U);
  EXPECT_EQ(scenario.people[0].waypoints.size(), 3U);
  EXPECT_TRUE(scenario.people[1].waypoints.empty());
  ASSERT_EQ(scenario.goals.size(), 3U);
  EXPECT_FALSE(scenario.goals[0].has_theta);
  EXPECT_EQ(scenario.goals[1].pose.x, 4.0);
  EXPECT_TRUE(scenario.goals[1].has_theta);
  EXPECT_EQ(scenario.goals[1].pose.theta, 1.5);
  EXPECT_TRUE(scenario.goals[2].expect_refused);
  EXPECT_EQ(scenario.goals[2].pose.theta, 0.7);
  ASSERT_EQ(scenario.drives.size(), 1U);
  EXPECT_EQ(scenario.drives[0].angular, -0.2);
}

TEST(ScenarioFile, HasEventsOfAllKinds) {
  const Scenario scenario = read(R"(
[[event]]
at = 10
kind = "carry"
x = 1.0
y = 2.0
theta = 0.5
duration = 4.0
[[event]]
at = 20
kind = "slip"
factor = 0.97
duration = 2.0
[[event]]
at = 30
kind = "bump"
dx = 0.1
dtheta = 0.2
[[event]]
at = 40
kind = "light"
daylight = 0.9
on = [3]
off = [4]
[[event]]
at = 50
kind = "door"
id = 7
open = false
[[event]]
at = 60
kind = "unplug"
device = "serial"
duration = 5.0
[[event]]
at = 70
kind = "lamp"
id = 4
dx = 0.3
[[event]]
at = 80
kind = "kill"
process = "localizer"
[[event]]
at = 90
kind = "clock"
step = 1.0
)");
  ASSERT_EQ(scenario.events.size(), 9U);
  EXPECT_EQ(scenario.events[0].kind, EventKind::kCarry);
  EXPECT_EQ(scenario.events[0].duration, 4.0);
  EXPECT_EQ(scenario.events[1].factor, 0.97);
  EXPECT_EQ(scenario.events[2].pose.theta, 0.2);
  EXPECT_EQ(*scenario.events[3].daylight, 0.9);
  EXPECT_THAT(scenario.events[3].off, ElementsAre(4));
  EXPECT_FALSE(scenario.events[4].open);
  EXPECT_EQ(scenario.events[5].device, "serial");
  EXPECT_EQ(scenario.events[6].id, 4);
  EXPECT_EQ(scenario.events[7].process, "localizer");
  EXPECT_EQ(scenario.events[8].step, 1.0);
}

TEST(ScenarioFile, LeavesOpenWhereACarryLeads) {
  const Scenario scenario = read("[[event]]\nat = 10\nkind = \"carry\"\n");
  EXPECT_FALSE(scenario.events.at(0).has_place);
  EXPECT_EQ(scenario.events.at(0).duration, 3.0);
  EXPECT_THAT(error_of("[[event]]\nat = 10\nkind = \"carry\"\ntheta = 1.0\n"), HasSubstr("needs x and y"));
}

TEST(ScenarioFile, HasADockABatteryAndJobs) {
  const Scenario scenario = read(
      "[dock]\nplace = \"desk\"\nreach = 0.1\n[battery]\nvoltage = 11.9\n[jobs]\ncount = 6\nkills = 2\n"
      "kinds = \"guides\"\n");
  ASSERT_TRUE(scenario.dock.has_value());
  EXPECT_EQ(scenario.dock->pose.x, 4.0);
  EXPECT_EQ(scenario.dock->reach, 0.1);
  EXPECT_EQ(scenario.battery_voltage, 11.9);
  EXPECT_EQ(scenario.jobs.count, 6);
  EXPECT_EQ(scenario.jobs.kills, 2);
  EXPECT_TRUE(scenario.jobs.only_guides);
  EXPECT_FALSE(read("").dock.has_value());
  EXPECT_EQ(read("").jobs.count, 0);
  EXPECT_THAT(error_of("[dock]\nplace = \"roof\"\n"), HasSubstr("must be the name of one of the building's places"));
  EXPECT_THAT(error_of("[dock]\nplace = \"door\"\n"), HasSubstr("must be a place with a heading"));
  EXPECT_THAT(error_of("[battery]\nvoltage = 5\n"), HasSubstr("battery.voltage"));
}

TEST(ScenarioFile, NamesFileLineAndKeyOfWhatIsWrong) {
  const std::string error = error_of("[lighting]\ndaylight = 1.5\n");
  EXPECT_THAT(error, HasSubstr("case.toml:4: lighting.daylight"));
  EXPECT_THAT(error, HasSubstr("between 0 and 1"));
}

TEST(ScenarioFile, ChoosesAmongLuminaires) {
  const Scenario scenario = read("[world]\nluminaires = [\"louvre\", \"opal-framed\"]\n");
  EXPECT_THAT(scenario.world.luminaires, ElementsAre(LuminaireKind::kLouvre, LuminaireKind::kOpalFramed));
  EXPECT_TRUE(read("").world.luminaires.empty());
}

TEST(ScenarioFile, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(error_of("speed = 1.0\n"), HasSubstr("unknown key \"speed\""));
  EXPECT_THAT(error_of("[world]\nwheels = 0.1\n"), HasSubstr("unknown key \"wheels\""));
  EXPECT_THAT(error_of("[world]\nluminaires = [\"chandelier\"]\n"), HasSubstr("must be of panel, louvre"));
  EXPECT_THAT(error_of("[[goal]]\nplace = \"roof\"\n"), HasSubstr("place"));
  EXPECT_THAT(error_of("[lighting]\noff = [3, 99]\n"), HasSubstr("99"));
  EXPECT_THAT(error_of("[[event]]\nat = 1\nkind = \"quake\"\n"), HasSubstr("carry, slip"));
  EXPECT_THAT(error_of("[[event]]\nat = 1\nkind = \"slip\"\nfactor = 0.9\nduration = 1.0\nx = 1.0\n"),
              HasSubstr("\"x\""));
  EXPECT_THAT(error_of("[[event]]\nat = 1\nkind = \"door\"\nid = 8\nopen = true\n"), HasSubstr("id = 8"));
  EXPECT_THAT(error_of("[[event]]\nat = 1\nkind = \"kill\"\nprocess = \"localiser\"\n"),
              HasSubstr("detector, localizer"));
  EXPECT_THAT(error_of("[[obstacle]]\nkind = \"tree\"\n"), HasSubstr("box, legs, glass, table"));
}

TEST(ScenarioFile, RefusesWhatIsHalf) {
  EXPECT_THAT(error_of("[start]\nx = 1.0\n"), HasSubstr("start.y"));
  EXPECT_THAT(error_of("[[hole]]\nx = 1.0\n"), HasSubstr("hole.y"));
  EXPECT_THAT(error_of("[start]\ntheta = 1.0\n"), HasSubstr("start.theta"));
  EXPECT_THAT(error_of("[[person]]\nwaypoints = [[1.0, 1.0]]\n"), HasSubstr("two points"));
  EXPECT_THAT(error_of("[[goal]]\nplace = \"desk\"\nx = 1.0\ny = 1.0\n"), HasSubstr("place"));
  EXPECT_THAT(error_of("[[event]]\nkind = \"bump\"\n"), HasSubstr("at is missing"));
  EXPECT_THAT(error_of("[world]\nmax_unlit_darker = 5.0\n"), HasSubstr("max_unlit_darker"));
}

TEST(ScenarioFile, NeedsItsFiles) {
  write_text(folder() / "missing.toml", "building = \"none.toml\"\nrobot = \"robot.toml\"\n");
  EXPECT_THROW(read_scenario(folder() / "missing.toml"), ConfigurationError);
  write_text(folder() / "missing.toml", "robot = \"robot.toml\"\n");
  EXPECT_THROW(read_scenario(folder() / "missing.toml"), ConfigurationError);
  EXPECT_THROW(read_scenario(folder() / "nowhere.toml"), ConfigurationError);
}

TEST(ScenarioFile, LoadsEveryScenarioThatIsShipped) {
  int files = 0;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::path(LUMINAV_SOURCE_DIR) / "launch" / "scenarios")) {
    if (entry.path().extension() == ".toml") {
      const Scenario scenario = read_scenario(entry.path());
      const Building building = read_building(scenario.building_file);
      const WorldTruth truth = draw_world(scenario, building, read_robot(scenario.robot_file));
      EXPECT_EQ(truth.building.fixtures.size(), building.fixtures.size()) << entry.path();
      ++files;
    }
  }
  EXPECT_GT(files, 0);
}

TEST(ScenarioFile, ReadsSensesThatFail) {
  const Scenario scenario = read(
      "[[event]]\nat = 1\nkind = \"deafen\"\ndiscs = [0, 7]\nduration = 20\n"
      "[[event]]\nat = 2\nkind = \"stick\"\n"
      "[[event]]\nat = 3\nkind = \"freeze\"\ndevice = \"encoder_left\"\n"
      "[[event]]\nat = 4\nkind = \"cover\"\n");
  ASSERT_EQ(scenario.events.size(), 4U);
  EXPECT_EQ(scenario.events[0].kind, EventKind::kDeafen);
  EXPECT_THAT(scenario.events[0].discs, ElementsAre(0, 7));
  EXPECT_EQ(scenario.events[0].duration, 20.0);
  EXPECT_TRUE(scenario.events[1].discs.empty());
  EXPECT_GT(scenario.events[1].duration, 1e6);
  EXPECT_EQ(scenario.events[2].device, "encoder_left");
  EXPECT_EQ(scenario.events[3].kind, EventKind::kCover);
  EXPECT_THAT(error_of("[[event]]\nat = 1\nkind = \"freeze\"\ndevice = \"sonar\"\n"), HasSubstr("encoder_left"));
  EXPECT_THAT(error_of("[[event]]\nat = 1\nkind = \"deafen\"\ndiscs = [-1]\n"), HasSubstr("discs"));
}

}  // namespace
}  // namespace luminav
