#include "services/common/configuration/building_edit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kHut = R"(# Where the hut stands.
name = "hut"
ceiling_height = 2.5

[[place]]
name = "desk"  # by the window
x = 1.0  # measured
y = 2.0
theta = 1.5

# The stairs go down here.
[[zone]]
name = "stairs"
polygon = [
  [1.0, 1.0],  # the rail
  [2.0, 1.0],
  [2.0, 2.0],
]
kind = "keep-out"

[[fixture]]
id = 1
x = 1.0
y = 1.0
length = 1.2
width = 0.3
)";

class BuildingEditTest : public testing::Test {
 protected:
  /// The text after an edit, which must say what the edit means.
  std::string edited(const BuildingEdit& edit) {
    const BuildingSource before = source_of(text_);
    text_ = with_edit(text_, before, edit);
    const Building after = source_of(text_).building;
    const Building meant = with_edit(before.building, edit);
    EXPECT_TRUE(are_same_zones(after.zones, meant.zones)) << text_;
    EXPECT_TRUE(are_same_places(after.places, meant.places)) << text_;
    EXPECT_TRUE(differ_in_zones_and_places_alone(after, before.building)) << text_;
    return text_;
  }
  BuildingSource source_of(const std::string& text) {
    return read_building_source(folder_.write("building.toml", text));
  }

  TemporaryFolder folder_;
  std::string text_ = kHut;
};

const Polygon kTriangle = {{4.0, 1.0}, {6.0, 1.0}, {5.0, 3.0}};

TEST_F(BuildingEditTest, AppendsANewZoneAndChangesNothingElse) {
  EXPECT_EQ(edited({.kind = BuildingEdit::Kind::kSetZone,
                    .zone = {.name = "ramp", .kind = ZoneKind::kOneWay, .polygon = kTriangle, .direction = 0.5}}),
            std::string(kHut) +
                "\n[[zone]]\nname = \"ramp\"\nkind = \"one-way\"\n"
                "polygon = [[4.000, 1.000], [6.000, 1.000], [5.000, 3.000]]\ndirection = 0.5000\n");
}

TEST_F(BuildingEditTest, ChangesAZoneInItsPlaceAndKeepsTheCommentsOfWhatStays) {
  Zone zone = source_of(kHut).building.zones.front();
  zone.name = "the \"great\" stairs";
  zone.kind = ZoneKind::kSlow;
  zone.speed = 0.15;
  const std::string text = edited({.kind = BuildingEdit::Kind::kSetZone, .name = "stairs", .zone = zone});
  EXPECT_THAT(text, HasSubstr("# the rail"));
  EXPECT_THAT(text, HasSubstr("kind = \"slow\"\nspeed = 0.150\n\n[[fixture]]"));
  zone.kind = ZoneKind::kQuiet;
  zone.polygon = kTriangle;
  const std::string moved = edited({.kind = BuildingEdit::Kind::kSetZone, .name = zone.name, .zone = zone});
  EXPECT_THAT(moved, Not(HasSubstr("speed")));
  EXPECT_THAT(moved, HasSubstr("# The stairs go down here.\n[[zone]]"));
}

TEST_F(BuildingEditTest, GivesAZoneHoursAndTakesThemAway) {
  Zone zone = source_of(kHut).building.zones.front();
  zone.hours = {8 * 3600, 12 * 3600, *read_days("Mo-Fr")};
  EXPECT_THAT(edited({.kind = BuildingEdit::Kind::kSetZone, .name = "stairs", .zone = zone}),
              HasSubstr("hours = \"08:00-12:00\"\ndays = \"Mo-Fr\"\n"));
  zone.hours = {.days = *read_days("Sa")};
  EXPECT_THAT(edited({.kind = BuildingEdit::Kind::kSetZone, .name = "stairs", .zone = zone}), Not(HasSubstr("hours")));
  zone.hours = {};
  EXPECT_THAT(edited({.kind = BuildingEdit::Kind::kSetZone, .name = "stairs", .zone = zone}), Not(HasSubstr("days")));
}

TEST_F(BuildingEditTest, MovesAPlaceAndTakesItsHeadingAway) {
  const std::string text =
      edited({.kind = BuildingEdit::Kind::kSetPlace, .name = "desk", .place = {"bench", {3.25, 4.5, 0.0}, false}});
  EXPECT_THAT(text, HasSubstr("name = \"bench\"  # by the window\nx = 3.250  # measured\ny = 4.500\n\n# The stairs"));
}

TEST_F(BuildingEditTest, RemovesATableAndLeavesTheNextOne) {
  EXPECT_THAT(edited({.kind = BuildingEdit::Kind::kRemovePlace, .name = "desk"}),
              HasSubstr("ceiling_height = 2.5\n\n\n# The stairs go down here.\n[[zone]]"));
  EXPECT_THAT(edited({.kind = BuildingEdit::Kind::kRemoveZone, .name = "stairs"}),
              HasSubstr("# The stairs go down here.\n\n[[fixture]]\nid = 1"));
}

TEST_F(BuildingEditTest, RefusesNamesThatAreTakenOrUnknown) {
  const auto objection = [&](const BuildingEdit& edit) -> std::string {
    try {
      with_edit(source_of(kHut).building, edit);
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(objection({.kind = BuildingEdit::Kind::kSetZone, .zone = {.name = "stairs", .polygon = kTriangle}}),
            "there is a zone \"stairs\" already");
  EXPECT_EQ(objection({.kind = BuildingEdit::Kind::kSetPlace, .name = "lift", .place = {"lift", {}, false}}),
            "there is no place \"lift\"");
  EXPECT_EQ(objection({.kind = BuildingEdit::Kind::kRemoveZone, .name = "ramp"}), "there is no zone \"ramp\"");
}

TEST_F(BuildingEditTest, SaysWhenATableIsWrittenInAnotherWay) {
  text_ = "place = [{name = \"desk\", x = 1.0, y = 2.0}]\nname = \"hut\"\nceiling_height = 2.5\n";
  EXPECT_THROW(edited({.kind = BuildingEdit::Kind::kRemovePlace, .name = "desk"}), ConfigurationError);
}

TEST_F(BuildingEditTest, KnowsWhatElseABuildingHas) {
  const Building hut = source_of(kHut).building;
  Building other = hut;
  other.zones.clear();
  other.places.clear();
  EXPECT_TRUE(differ_in_zones_and_places_alone(hut, other));
  other.fixtures[0].world_from_fixture.x += 0.01;
  EXPECT_FALSE(differ_in_zones_and_places_alone(hut, other));
}

}  // namespace
}  // namespace luminav
