#include "services/common/process/running_system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000;
const std::filesystem::path kLaunch = LUMINAV_SOURCE_DIR "/launch";
const std::filesystem::path kRobot = kLaunch / "robots/p3dx.toml";
const std::filesystem::path kOffice = kLaunch / "buildings/office/building.toml";
const std::filesystem::path kLaboratory = kLaunch / "buildings/laboratory/building.toml";

node_status_t status_of(const std::string& process, const SystemFiles& files) {
  node_status_t status{};
  status.process = process;
  status.host = "desk";
  status.building = files.building;
  status.building_hash = files.building_hash;
  status.robot = files.robot;
  status.robot_hash = files.robot_hash;
  return status;
}

TEST(SystemFiles, TellBuildingsAndTheirVersionsApart) {
  const SystemFiles office = identify(kRobot, kOffice);
  EXPECT_EQ(office.building, "office");
  EXPECT_EQ(office.robot, "p3dx");
  EXPECT_EQ(difference(office, status_of("planner", identify(kRobot, kOffice))), "");
  EXPECT_EQ(difference(office, status_of("planner", identify(kRobot, kLaboratory))),
            "building office, but planner@desk has laboratory");
  TemporaryFolder folder;
  std::filesystem::copy(kOffice.parent_path(), folder.path() / "office");
  const std::filesystem::path copy = folder.path() / "office/building.toml";
  EXPECT_EQ(identify(kRobot, copy).building_hash, office.building_hash) << "wherever it lies";
  write_whole_file(copy, read_whole_file(copy) + "\n[[place]]\nname = \"new\"\nx = 1.0\ny = 1.0\n");
  EXPECT_THAT(difference(office, status_of("planner", identify(kRobot, copy))), HasSubstr("another file of that name"));
}

TEST(SystemFiles, OfProcessesThatNeedNoneDifferFromNothing) {
  const SystemFiles office = identify(kRobot, kOffice);
  EXPECT_EQ(difference(office, status_of("p3dx", identify(kRobot, ""))), "");
  EXPECT_EQ(difference(office, status_of("deputy", {})), "");
}

TEST(RunningSystem, ObjectsAsLongAsAnotherBuildingIsHeardAndALittleLonger) {
  const SystemFiles office = identify(kRobot, kOffice);
  RunningSystem system;
  system.hear(status_of("localizer", office), 0);
  EXPECT_EQ(system.objection(office, 0), "");
  system.hear(status_of("planner", identify(kRobot, kLaboratory)), kSecond);
  EXPECT_EQ(system.objection(office, 4 * kSecond), "building office, but planner@desk has laboratory");
  EXPECT_THAT(system.disagreement(4 * kSecond), HasSubstr("office"));
  EXPECT_THAT(system.disagreement(4 * kSecond), HasSubstr("laboratory"));
  EXPECT_EQ(system.objection(office, 10 * kSecond), "");
  system.hear(status_of("planner", office), 11 * kSecond);
  EXPECT_EQ(system.disagreement(11 * kSecond), "");
}

TEST(RunningSystem, HearsTwoProcessesOfOneName) {
  RunningSystem system;
  for (const auto& building : {kOffice, kLaboratory}) {
    node_status_t status = status_of("planner", identify(kRobot, building));
    status.instance = static_cast<std::int64_t>(building.string().size());
    system.hear(status, 0);
  }
  EXPECT_THAT(system.disagreement(0), HasSubstr("laboratory"));
}

TEST(RunningSystem, DoesNotMindWhoOnlyLooksOn) {
  const SystemFiles office = identify(kRobot, kOffice);
  RunningSystem system;
  system.hear(status_of("viewer", identify(kRobot, kLaboratory)), 0);
  EXPECT_EQ(system.objection(office, 0), "");
  EXPECT_FALSE(system.files());
}

TEST(RunningSystem, KnowsTheFilesOfThePlannerFirst) {
  RunningSystem system;
  system.hear(status_of("localizer", {"a", 1, "", 0}), 0);
  system.hear(status_of("planner", {"b", 2, "", 0}), 0);
  system.hear(status_of("controller", {"c", 3, "", 0}), 0);
  EXPECT_EQ(system.files()->building, "b");
}

TEST(SystemFiles, AreFoundByTheirSumsWhereTheyAreRememberedOrShipped) {
  TemporaryFolder home;
  const char* before = std::getenv("HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("HOME", home.path().c_str(), 1);
  const std::filesystem::path copy = home.path() / "mine";
  std::filesystem::copy(kOffice.parent_path(), copy);
  write_whole_file(copy / "building.toml", read_whole_file(copy / "building.toml") + "# mine\n");
  const SystemFiles mine = identify(kRobot, copy / "building.toml");
  EXPECT_EQ(find_building(mine.building_hash, {kOffice}), "");
  EXPECT_EQ(find_building(identify(kRobot, kOffice).building_hash, {kLaboratory, kOffice}), kOffice.string());
  remember_files(kRobot, copy / "building.toml");
  EXPECT_EQ(find_building(mine.building_hash, {}), (copy / "building.toml").string());
  EXPECT_EQ(find_robot(mine.robot_hash, {}), kRobot.lexically_normal().string());
  write_whole_file(copy / "building.toml", read_whole_file(copy / "building.toml") + "# changed\n");
  EXPECT_EQ(find_building(mine.building_hash, {}), "") << "a file that was changed is another one";
  setenv("HOME", kept.c_str(), 1);
}

}  // namespace
}  // namespace luminav
