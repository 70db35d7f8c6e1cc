#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "services/common/configuration/file_versions.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/viewer/building/edit_desk.hpp"
#include "services/viewer/building/tour_changes.hpp"
#include "services/viewer/request_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;
using Json = nlohmann::json;

const std::filesystem::path kLaboratory = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory";
constexpr std::int64_t kNoon = 1'769'860'800'000'000;  // [us] 31 January 2026

constexpr const char* kTours = R"(home = "lab-door"   # ours
[[tour]]
name = "morning"
at = "09:30"
[[tour.stop]]
place = "workbench"
text = "The bench."  # of oak
)";

Tour tour(const std::string& name, const std::string& place = "lab-door") {
  return {.name = name, .stops = {{place, 20.0, "Here."}}};
}

class TourDeskTest : public testing::Test {
 protected:
  TourDeskTest() { std::filesystem::copy(kLaboratory, folder_.path() / "mine"); }

  void begin(const std::string& text) {
    if (!text.empty()) {
      write_whole_file(file_, text);
    }
    desk_ = std::make_unique<TourDesk>(changes());
  }
  [[nodiscard]] TourChanges changes() const { return {file_, building_file_}; }
  [[nodiscard]] static Json shown(const TourDesk& desk) { return Json::parse(desk.json({})); }
  [[nodiscard]] Json shown() const { return shown(*desk_); }
  [[nodiscard]] std::string version() const { return shown()["version"]; }
  [[nodiscard]] std::string text() const { return read_whole_file(file_); }

  /// Orders it, and waits for what becomes of it.
  Json outcome(TourDesk& desk, TourOrder order) {
    const std::int64_t id = desk.order(std::move(order), kNoon);
    for (;;) {
      const Json all = shown(desk);
      for (const Json& known : all["orders"]) {
        if (known["id"] == id && known["fate"] != "waiting") {
          return known;
        }
      }
      std::this_thread::yield();
    }
  }
  Json outcome(const TourEdit& edit, bool accepts = false) {
    return outcome(*desk_, {.version = version(), .accepts = accepts, .edit = edit});
  }
  Json undo() { return outcome(*desk_, {.version = version(), .undoes = true}); }

  TemporaryFolder folder_;
  std::filesystem::path building_file_ = folder_.path() / "mine/building.toml";
  std::filesystem::path file_ = folder_.path() / "mine/jobs.toml";
  std::unique_ptr<TourDesk> desk_;
};

TEST_F(TourDeskTest, SavesATourKeepsTheVersionBeforeAndTakesItBack) {
  begin(kTours);
  EXPECT_THAT(shown()["tours"], SizeIs(1));
  EXPECT_EQ(shown()["tours"][0]["at"], "09:30");
  EXPECT_EQ(outcome({.tour = tour("noon")})["fate"], "done");
  EXPECT_TRUE(desk_->take_news());
  EXPECT_EQ(shown()["tours"][1]["name"], "noon");
  EXPECT_EQ(shown()["tours"][1]["stops"][0]["pause"], 20.0);
  EXPECT_EQ(shown()["undo"], "jobs-before-2026-01-31-120000.toml");
  EXPECT_EQ(text().find(kTours), 0U) << "all that was there stays, comments included";
  EXPECT_EQ(undo()["fate"], "done");
  EXPECT_EQ(text(), kTours);
  EXPECT_THAT(undo()["said"], HasSubstr("no earlier version"));
}

TEST_F(TourDeskTest, MakesAFileWhereThereIsNone) {
  begin("");
  EXPECT_EQ(outcome({.tour = tour("noon")})["fate"], "done");
  EXPECT_THAT(text(), HasSubstr("noon"));
  EXPECT_EQ(undo()["fate"], "done");
  EXPECT_EQ(text(), "");
}

TEST_F(TourDeskTest, MovesAndRemovesTours) {
  begin(kTours);
  EXPECT_EQ(outcome({.tour = tour("noon")})["fate"], "done");
  EXPECT_EQ(outcome({.kind = TourEdit::Kind::kMove, .name = "noon", .before = "morning"})["fate"], "done");
  EXPECT_EQ(shown()["tours"][0]["name"], "noon");
  EXPECT_EQ(outcome({.kind = TourEdit::Kind::kRemove, .name = "morning"})["fate"], "done");
  EXPECT_THAT(shown()["tours"], SizeIs(1));
  EXPECT_THAT(text(), HasSubstr("# ours"));
  EXPECT_THAT(outcome({.kind = TourEdit::Kind::kRemove, .name = "morning"})["said"], HasSubstr("no tour \"morning\""));
}

TEST_F(TourDeskTest, OverwritesNobodysEdit) {
  begin(kTours);
  const std::string seen = version();
  EXPECT_EQ(outcome({.tour = tour("mine")})["fate"], "done");
  EXPECT_THROW(desk_->order({.version = seen, .edit = {.tour = tour("yours")}}, kNoon), StaleVersion);
  write_whole_file(file_, text() + "# by hand\n");
  EXPECT_THAT(outcome({.tour = tour("yours")})["said"], HasSubstr("somebody else has changed the tours"));
  EXPECT_EQ(outcome({.tour = tour("yours")})["fate"], "done") << "the desk has read it again";
  EXPECT_THAT(text(), HasSubstr("# by hand"));
}

TEST_F(TourDeskTest, TwoViewersOfOneFileSaveOneEditOfTwo) {
  begin(kTours);
  TourDesk other(changes());
  const std::string seen = version();
  EXPECT_EQ(outcome({.tour = tour("mine")})["fate"], "done");
  EXPECT_THAT(outcome(other, {.version = seen, .edit = {.tour = tour("yours")}})["said"], HasSubstr("somebody else"));
  EXPECT_THAT(text(), Not(HasSubstr("yours")));
}

TEST_F(TourDeskTest, ShowsWhatSomebodyElseHasSaved) {
  begin(kTours);
  write_whole_file(file_, std::string(kTours) + "[[tour]]\nname = \"noon\"\n[[tour.stop]]\nplace = \"lab-door\"\n");
  desk_->look();
  EXPECT_THAT(shown()["tours"], SizeIs(2));
  write_whole_file(file_, "[[tour");
  desk_->look();
  EXPECT_THAT(shown()["tours"], SizeIs(2)) << "half a file is not shown";
  EXPECT_EQ(outcome({.tour = tour("late")})["fate"], "refused");
  EXPECT_EQ(text(), "[[tour");
}

TEST_F(TourDeskTest, AsksBeforeTwoToursStartAtOnce) {
  begin(kTours);
  Tour second = tour("second");
  second.at = 34'260;
  const Json asked = outcome({.tour = second});
  EXPECT_EQ(asked["fate"], "asks");
  EXPECT_THAT(asked["found"].dump(), HasSubstr("morning"));
  EXPECT_EQ(text(), kTours);
  EXPECT_EQ(outcome({.tour = second}, true)["fate"], "done");
  second.stops[0].text = "There.";
  EXPECT_EQ(outcome({.name = "second", .tour = second})["fate"], "done") << "what was so before is not asked again";
}

TEST_F(TourDeskTest, AsksBeforeATourLeadsWhereNobodyCanStand) {
  begin(kTours);
  write_whole_file(building_file_,
                   read_whole_file(building_file_) + "\n[[place]]\nname = \"wall\"\nx = 0.0\ny = 0.0\n");
  EXPECT_EQ(outcome({.tour = tour("t", "wall")})["fate"], "asks");
  EXPECT_THAT(outcome({.tour = tour("t", "attic")})["said"], HasSubstr("no place \"attic\""));
}

TEST_F(TourDeskTest, UndoesNothingButTours) {
  begin(kTours);
  write_whole_file(file_.parent_path() / "jobs-before-2026-01-01-000000.toml", "home = \"workbench\"\n");
  desk_->read_again();
  EXPECT_THAT(undo()["said"], HasSubstr("differs in more than tours"));
}

TEST_F(TourDeskTest, EditsAFileInAnotherFolder) {
  std::filesystem::create_directory(folder_.path() / "other");
  file_ = folder_.path() / "other/rounds.toml";
  begin(kTours);
  EXPECT_EQ(outcome({.tour = tour("noon")})["fate"], "done");
  EXPECT_EQ(shown()["undo"], "rounds-before-2026-01-31-120000.toml");
}

}  // namespace
}  // namespace luminav
