#include "services/viewer/building/edit_desk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/file_versions.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/viewer/request_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::json;

const std::filesystem::path kLaboratory = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory";
constexpr std::int64_t kNoon = 1'769'860'800'000'000;  // [us] 31 January 2026

const Polygon kSquare = {{1.0, 1.0}, {1.5, 1.0}, {1.5, 1.5}, {1.0, 1.5}};

BuildingEdit zone_edit(const std::string& name, const Polygon& polygon = kSquare) {
  return {.kind = BuildingEdit::Kind::kSetZone,
          .zone = {.name = name, .kind = ZoneKind::kSlow, .polygon = polygon, .speed = 0.2}};
}

class BuildingDeskTest : public testing::Test {
 protected:
  [[nodiscard]] Json shown() const { return Json::parse(desk_->json(universal_time(kNoon))); }
  [[nodiscard]] std::string version() const { return shown()["version"]; }

  /// Orders it, and waits for what becomes of it.
  Json outcome(BuildingOrder order) {
    const std::int64_t id = desk_->order(std::move(order), kNoon);
    for (;;) {
      const Json now = shown();
      for (const Json& known : now["orders"]) {
        if (known["id"] == id && known["fate"] != "waiting") {
          return known;
        }
      }
      std::this_thread::yield();
    }
  }
  Json outcome(const BuildingEdit& edit, bool accepts = false) {
    return outcome(BuildingOrder{.version = version(), .accepts = accepts, .edit = edit});
  }
  Json undo() { return outcome(BuildingOrder{.version = version(), .undoes = true}); }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(file_.parent_path())) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  static std::filesystem::path copy_of_laboratory(const std::filesystem::path& folder) {
    std::filesystem::copy(kLaboratory, folder / "mine");
    return folder / "mine/building.toml";
  }

  [[nodiscard]] BuildingChanges changes() const { return {file_, jobs_file_of(file_)}; }

  TemporaryFolder folder_;
  std::filesystem::path file_ = copy_of_laboratory(folder_.path());
  std::unique_ptr<BuildingDesk> desk_ = std::make_unique<BuildingDesk>(changes());
};

TEST_F(BuildingDeskTest, SavesAnEditKeepsTheVersionBeforeAndTakesItBack) {
  const std::string before = read_whole_file(file_);
  EXPECT_EQ(shown()["undo"], nullptr);
  EXPECT_EQ(outcome(zone_edit("wet floor"))["fate"], "done");
  EXPECT_TRUE(desk_->take_news());
  EXPECT_FALSE(desk_->take_news());
  EXPECT_EQ(read_building(file_).zones.back().name, "wet floor");
  EXPECT_EQ(desk_->contents()->zones.back().name, "wet floor");
  EXPECT_EQ(shown()["zones"].back()["speed"], 0.2);
  EXPECT_THAT(files(), ElementsAre("building-before-2026-01-31-120000.toml", "building.toml", "map.pgm", "map.yaml"));
  EXPECT_EQ(shown()["undo"], "building-before-2026-01-31-120000.toml");
  const std::string with_zone = read_whole_file(file_);
  EXPECT_EQ(undo()["fate"], "done");
  EXPECT_EQ(read_whole_file(file_), before);
  EXPECT_THAT(files(), ElementsAre("building-undone-2026-01-31-120000.toml", "building.toml", "map.pgm", "map.yaml"));
  EXPECT_EQ(read_whole_file(file_.parent_path() / "building-undone-2026-01-31-120000.toml"), with_zone);
  EXPECT_THAT(undo()["said"], HasSubstr("no earlier version"));
}

TEST_F(BuildingDeskTest, TakesSeveralEditsBackOneByOne) {
  const std::string before = read_whole_file(file_);
  for (const char* name : {"one", "two", "three"}) {
    EXPECT_EQ(outcome(zone_edit(name), true)["fate"], "done");
  }
  for (const char* name : {"two", "one"}) {
    undo();
    EXPECT_EQ(read_building(file_).zones.back().name, name);
  }
  undo();
  EXPECT_EQ(read_whole_file(file_), before);
}

TEST_F(BuildingDeskTest, OverwritesNobodysEdit) {
  const std::string seen = version();
  EXPECT_EQ(outcome(zone_edit("mine"))["fate"], "done");
  EXPECT_THROW(desk_->order({.version = seen, .edit = zone_edit("yours")}, kNoon), StaleVersion);
  write_whole_file(file_, read_whole_file(file_) + "# by hand\n");
  EXPECT_THAT(outcome(zone_edit("yours"))["said"], HasSubstr("somebody else has changed the building"));
  EXPECT_EQ(outcome(zone_edit("yours"), true)["fate"], "done") << "the desk has read it again";
  EXPECT_THAT(read_whole_file(file_), HasSubstr("# by hand"));
}

TEST_F(BuildingDeskTest, TwoViewersOfOneFileSaveOneEditOfTwo) {
  BuildingDesk other(changes());
  const std::string seen = version();
  other.order({.version = seen, .edit = zone_edit("yours")}, kNoon);
  const Json mine = outcome(BuildingOrder{.version = seen, .edit = zone_edit("mine")});
  Json yours;
  do {
    yours = Json::parse(other.json(universal_time(kNoon)))["orders"];
  } while (yours.empty() || yours.back()["fate"] == "waiting");
  yours = yours.back();
  EXPECT_NE(mine["fate"] == "done", yours["fate"] == "done");
  EXPECT_EQ(read_building(file_).zones.size(), 1U);
  EXPECT_THAT((mine["fate"] == "done" ? yours : mine)["said"], HasSubstr("somebody else"));
}

TEST_F(BuildingDeskTest, AsksBeforeItSavesWhatCheckBuildingFindsWrong) {
  const std::string before = read_whole_file(file_);
  const Place place = read_building(file_).places.front();
  const Eigen::Vector2d p = place.pose.position();
  BuildingEdit edit = zone_edit("hole", {{p.x() - 0.5, p.y() - 0.5}, {p.x() + 0.5, p.y() - 0.5}, {p.x(), p.y() + 0.5}});
  edit.zone.kind = ZoneKind::kKeepOut;
  const Json asked = outcome(edit);
  EXPECT_EQ(asked["fate"], "asks");
  EXPECT_THAT(asked["found"].dump(), HasSubstr(place.name));
  EXPECT_EQ(read_whole_file(file_), before);
  EXPECT_EQ(outcome(edit, true)["fate"], "done");
  EXPECT_THAT(outcome(zone_edit("far", {{2.0, 1.0}, {2.5, 1.0}, {2.5, 1.5}}))["found"], IsEmpty())
      << "what was wrong before is not asked again";
}

TEST_F(BuildingDeskTest, KeepsPlacesThatJobsNeed) {
  const std::vector<Place> places = read_building(file_).places;
  write_whole_file(file_.parent_path() / "jobs.toml", "home = \"" + places[0].name +
                                                          "\"\n[[tour]]\nname = \"round\"\n[[tour.stop]]\nplace = \"" +
                                                          places[1].name + "\"\n");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_THAT(outcome({.kind = BuildingEdit::Kind::kRemovePlace, .name = places[i].name})["said"],
                HasSubstr("change that first"));
  }
  EXPECT_EQ(outcome({.kind = BuildingEdit::Kind::kRemovePlace, .name = places[2].name})["fate"], "done");
}

TEST_F(BuildingDeskTest, UndoesNothingButZonesAndPlaces) {
  write_whole_file(file_.parent_path() / "building-before-2026-01-01-000000.toml",
                   "name = \"laboratory\"\nceiling_height = 2.8\nmap = \"map.yaml\"\n");
  desk_->read_again();
  EXPECT_THAT(undo()["said"], HasSubstr("differs in more than zones and places"));
}

TEST_F(BuildingDeskTest, SavesNothingIntoAFileThatTheProcessesHaveNot) {
  const std::string by_hand =
      read_whole_file(file_) + "\n[[fixture]]\nid = 999\nx = 3.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n";
  write_whole_file(file_, by_hand);
  EXPECT_THAT(outcome(zone_edit("a"))["said"], HasSubstr("start the system anew first"));
  desk_->read_again();
  EXPECT_EQ(desk_->contents()->fixtures.size() + 1, read_building(file_).fixtures.size());
  EXPECT_EQ(read_whole_file(file_), by_hand);
}

TEST_F(BuildingDeskTest, SaysWhyItTakesNoEdit) {
  desk_->object("planner@robot has the file");
  EXPECT_THROW(desk_->order({.version = version(), .edit = zone_edit("a")}, kNoon), RequestError);
  EXPECT_EQ(shown()["objection"], "planner@robot has the file");
  desk_->object("");
  EXPECT_EQ(outcome(zone_edit("a"))["fate"], "done");
  EXPECT_THAT(outcome({.kind = BuildingEdit::Kind::kRemoveZone, .name = "b"})["said"], HasSubstr("no zone \"b\""));
  write_whole_file(file_, "name = ");
  desk_->read_again();
  EXPECT_EQ(shown()["zones"].back()["name"], "a") << "half a file is not shown";
}

TEST_F(BuildingDeskTest, EndsWithAnEditThatNobodyWaitsFor) {
  desk_->order({.version = version(), .edit = zone_edit("a")}, kNoon);
  desk_.reset();
  EXPECT_THAT(read_building(file_).name, "laboratory") << "whole, with the zone or without";
}

}  // namespace
}  // namespace luminav
