#include "services/common/building/building_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::Not;

/// A hall of 20 x 10 m with walls of 0.2 m, and one across it at x = 12 m that leaves no door.
PriorMap hall() {
  PriorMap map;
  map.geometry = {.resolution = 0.1, .origin = {0.0, 0.0}, .columns = 200, .rows = 100};
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 200; ++column) {
      const bool is_outer = row < 2 || row >= 98 || column < 2 || column >= 198;
      const bool is_across = column == 120 || column == 121;
      const bool is_table = row >= 40 && row < 50 && column >= 30 && column < 50;
      if (is_outer || is_across || is_table) {
        map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return map;
}

std::vector<BuildingFinding> findings_of(const std::string& tables) {
  const TemporaryFolder folder;
  const PriorMap map = hall();
  return check_building(
      read_building_source(folder.write("building.toml", "name = \"hall\"\nceiling_height = 2.8\n" + tables)), &map);
}

testing::Matcher<BuildingFinding> finding(FindingKind kind, int line, const char* text) {
  return AllOf(Field(&BuildingFinding::kind, kind), Field(&BuildingFinding::line, line),
               Field(&BuildingFinding::text, HasSubstr(text)));
}

TEST(BuildingCheck, NamesBothFixturesThatOverlap) {
  const auto findings = findings_of(
      "[[fixture]]\nid = 4\nx = 3.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n"
      "[[fixture]]\nid = 9\nx = 3.5\ny = 3.4\ntheta = 1.5708\nlength = 1.2\nwidth = 0.3\n"
      "[[fixture]]\nid = 10\nx = 3.0\ny = 7.0\nlength = 1.2\nwidth = 0.3\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 9, "fixture 9 overlaps fixture 4 (line 3)")));
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::text, HasSubstr("fixture 10")))));
}

TEST(BuildingCheck, TellsNeighboursThatOnlyTouchCornersApart) {
  // the circles round them meet, they don't: 1.2 x 0.3 m, side by side at 0.4 m
  const auto findings = findings_of(
      "[[fixture]]\nid = 1\nx = 3.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n"
      "[[fixture]]\nid = 2\nx = 3.0\ny = 3.4\nlength = 1.2\nwidth = 0.3\n");
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::kind, FindingKind::kError))));
}

TEST(BuildingCheck, FindsAFixtureInAWallButNotOneOverATable) {
  const auto findings = findings_of(
      "[[fixture]]\nid = 1\nx = 12.1\ny = 3.0\ntheta = 1.5708\nlength = 1.2\nwidth = 0.3\n"
      "[[fixture]]\nid = 2\nx = 4.0\ny = 4.5\nlength = 1.2\nwidth = 0.3\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 3, "is in a wall")));
  EXPECT_THAT(findings, Not(Contains(finding(FindingKind::kError, 9, ""))));
}

TEST(BuildingCheck, FindsWhatIsOutsideTheMapOrAboveTheCeilingOrOfNoSize) {
  const auto findings = findings_of(
      "[[fixture]]\nid = 1\nx = 25.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n"
      "[[fixture]]\nid = 2\nx = 3.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\nheight = 3.2\n"
      "[[fixture]]\nid = 3\nx = 8.0\ny = 3.0\nlength = 6.0\nwidth = 0.3\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 3, "outside the map")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 9, "above the ceiling")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 16, "6.00 x 0.30 m")));
}

TEST(BuildingCheck, FindsPlacesWhereNobodyCanStandOrGo) {
  const auto findings = findings_of(
      "[[fixture]]\nid = 1\nx = 3.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n"
      "[[place]]\nname = \"table\"\nx = 4.0\ny = 4.5\n"
      "[[place]]\nname = \"walled in\"\nx = 16.0\ny = 5.0\n"
      "[[place]]\nname = \"hall\"\nx = 8.0\ny = 5.0\n"
      "[[door]]\nid = 1\nx = 12.1\ny = 5.0\ntheta = 1.5708\nwidth = 0.9\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 9, "does not fit there")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 13, "no way leads there")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 21, "is a wall in the map")));
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::line, 17))));
}

TEST(BuildingCheck, WarnsOfRoundFixturesThatNothingGivesAHeading) {
  const std::string round = "[[fixture]]\nid = 1\nshape = \"round\"\nx = 3.0\ny = 3.0\ndiameter = 0.3\n";
  EXPECT_THAT(findings_of(round), Contains(finding(FindingKind::kWarning, 0, "1 of 1 fixtures are round")));
  EXPECT_THAT(findings_of(round + "[[fixture]]\nid = 2\nx = 5.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n"),
              Not(Contains(Field(&BuildingFinding::text, HasSubstr("are round")))));
}

TEST(BuildingCheck, SaysThatABuildingWithoutFixturesIsOfNoUse) {
  EXPECT_THAT(findings_of(""), Contains(finding(FindingKind::kError, 1, "no fixture")));
}

TEST(BuildingCheck, WarnsOfPlacesAndDoorsBesideWhatTheMapDoesNotKnow) {
  const TemporaryFolder folder;
  PriorMap map = hall();
  for (int row = 2; row < 98; ++row) {
    for (int column = 2; column < 198; ++column) {
      // a stair ends at x = 5 m, and nobody has been behind the wall at x = 12 m
      Prior& cell = map.cells[map.geometry.index({column, row})];
      cell = column < 50 || column > 121 ? Prior::kUnknown : cell;
    }
  }
  const auto source = read_building_source(folder.write("building.toml",
                                                        "name = \"hall\"\nceiling_height = 2.8\n"
                                                        "[[place]]\nname = \"landing\"\nx = 5.6\ny = 6.0\n"
                                                        "[[place]]\nname = \"desk\"\nx = 6.4\ny = 6.0\n"
                                                        "[[place]]\nname = \"behind the wall\"\nx = 11.5\ny = 6.0\n"
                                                        "[[door]]\nid = 3\nx = 5.3\ny = 3.0\n"));
  const auto findings = check_building(source, &map);
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 3, "m from what the map does not know")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 15, "door 3")));
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::text, HasSubstr("\"desk\" at (6.40, 6.00) is")))));
  EXPECT_THAT(findings,
              Not(Contains(Field(&BuildingFinding::text, HasSubstr("behind the wall\" at (11.50, 6.00) is")))));
}

TEST(BuildingCheck, NamesThePlacesThatAKeepOutZoneTakesAway) {
  const std::string places =
      "[[place]]\nname = \"landing\"\nx = 9.0\ny = 3.0\n"
      "[[place]]\nname = \"cellar\"\nx = 11.2\ny = 3.0\n"
      "[[place]]\nname = \"desk\"\nx = 16.0\ny = 2.0\n";
  EXPECT_THAT(findings_of(places), Not(Contains(Field(&BuildingFinding::text, HasSubstr("\"landing\"")))));
  const auto findings =
      findings_of(places + "[[zone]]\nname = \"stairs\"\npolygon = [[8, 0], [10, 0], [10, 10], [8, 10]]\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 3, "\"landing\" at (9.00, 3.00) lies in")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 7, "\"cellar\" at (11.20, 3.00): no way leads")));
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::text, HasSubstr("\"desk\"")))));
}

TEST(BuildingCheck, SaysWhatAKeepOutZoneCutsOff) {
  const std::string tables =
      "[[fixture]]\nid = 1\nx = 3.0\ny = 3.0\nlength = 1.2\nwidth = 0.3\n"
      "[[place]]\nname = \"cellar\"\nx = 11.2\ny = 3.0\n"
      "[[zone]]\nname = \"stairs\"\npolygon = [[8, 0], [9, 0], [9, 10], [8, 10]]\n";
  EXPECT_THAT(findings_of(tables),
              Contains(finding(FindingKind::kError, 13, "keep-out zone \"stairs\" cuts off 2")));  // 2.5 x 9.1 m^2
  EXPECT_THAT(findings_of(tables), Contains(Field(&BuildingFinding::text, HasSubstr("with place \"cellar\""))));
  const auto halves = findings_of(
      "[[zone]]\nname = \"south\"\npolygon = [[8, 0], [9, 0], [9, 5.2], [8, 5.2]]\n"
      "[[zone]]\nname = \"north\"\npolygon = [[8, 5.4], [9, 5.4], [9, 10], [8, 10]]\n"
      "[[zone]]\nname = \"small\"\nkind = \"slow\"\npolygon = [[3, 2], [4, 2], [4, 3]]\n");
  EXPECT_THAT(halves, Contains(finding(FindingKind::kWarning, 3, "keep-out zone \"south\" cuts off")));
  EXPECT_THAT(halves, Not(Contains(Field(&BuildingFinding::text, HasSubstr("small")))));
}

TEST(BuildingCheck, SaysWhichZonesHaveHoursAndForgivesWhatTheyTakeAway) {
  const std::string places =
      "[[place]]\nname = \"landing\"\nx = 8.5\ny = 3.0\n"
      "[[place]]\nname = \"cellar\"\nx = 11.2\ny = 3.0\n";
  const std::string zone = "[[zone]]\nname = \"yard\"\npolygon = [[8, 0], [9, 0], [9, 10], [8, 10]]\n";
  const auto findings = findings_of(places + zone + "hours = \"08:00-12:00\"\ndays = \"Mo-Fr\"\n");
  EXPECT_THAT(findings,
              Contains(finding(FindingKind::kNote, 11, "keep-out zone \"yard\" (Mo-Fr 08:00-12:00) has hours")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 3, "no goal there is taken, while zones with hours")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 7, "no way leads there from most of the building, w")));
  EXPECT_THAT(findings, Not(Contains(finding(FindingKind::kError, 11, ""))));
  const auto always = findings_of(places + zone);
  EXPECT_THAT(always, Contains(finding(FindingKind::kError, 3, "no goal there is taken")));
  EXPECT_THAT(always, Not(Contains(Field(&BuildingFinding::text, HasSubstr("hours")))));
}

TEST(BuildingCheck, ForgivesNoZoneWithoutHoursBesideOneThatHasSome) {
  const auto findings = findings_of(
      "[[place]]\nname = \"cellar\"\nx = 11.2\ny = 3.0\n"
      "[[zone]]\nname = \"stairs\"\npolygon = [[8, 0], [9, 0], [9, 10], [8, 10]]\n"
      "[[zone]]\nname = \"yard\"\npolygon = [[9.2, 0], [9.6, 0], [9.6, 10], [9.2, 10]]\ndays = \"Sa\"\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 3, "no way leads there")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kError, 7, "keep-out zone \"stairs\" cuts off")));
  EXPECT_EQ(findings.back().line, 0) << "what is said of the whole comes last";
}

TEST(BuildingCheck, LetsZonesContradictEachOtherThatNeverMeet) {
  const auto with = [](const char* hours) {
    return findings_of(
        "[[zone]]\nname = \"in\"\nkind = \"one-way\"\ndirection = 0\nhours = \"08:00-12:00\"\n"
        "polygon = [[8, 1], [9, 1], [9, 3], [8, 3]]\n"
        "[[zone]]\nname = \"out\"\nkind = \"one-way\"\ndirection = 3.1416\nhours = \"" +
        std::string(hours) + "\"\npolygon = [[8, 1], [9, 1], [9, 3], [8, 3]]\n");
  };
  EXPECT_THAT(with("12:00-18:00"), Not(Contains(Field(&BuildingFinding::text, HasSubstr("overlaps")))));
  EXPECT_THAT(with("11:00-18:00"), Contains(Field(&BuildingFinding::text, HasSubstr("overlaps"))));
}

TEST(BuildingCheck, SaysWhatOneWayZonesLetNobodyOutOf) {
  const auto with = [](const char* direction) {
    return findings_of(
        "[[place]]\nname = \"desk\"\nx = 11.2\ny = 3.0\n"
        "[[zone]]\nname = \"lane\"\nkind = \"one-way\"\ndirection = " +
        std::string(direction) + "\npolygon = [[8, 0], [9, 0], [9, 10], [8, 10]]\n");
  };
  EXPECT_THAT(with("0"), Contains(finding(FindingKind::kError, 7, "let no way lead out of")));
  EXPECT_THAT(with("0"), Not(Contains(Field(&BuildingFinding::text, HasSubstr("let no way lead into")))));
  EXPECT_THAT(with("3.1416"), Contains(finding(FindingKind::kError, 7, "let no way lead into")));
  EXPECT_THAT(with("3.1416"), Contains(Field(&BuildingFinding::text, HasSubstr("with place \"desk\""))));
}

TEST(BuildingCheck, NamesZonesThatContradictEachOther) {
  const auto findings = findings_of(
      "[[zone]]\nname = \"stairs\"\npolygon = [[8, 1], [9, 1], [9, 3], [8, 3]]\n"
      "[[zone]]\nname = \"foyer\"\nkind = \"slow\"\npolygon = [[8.5, 2], [11, 2], [11, 4], [8.5, 4]]\n"
      "[[zone]]\nname = \"beside\"\npolygon = [[9, 1], [9.5, 1], [9.5, 1.9], [9, 1.9]]\n"
      "[[zone]]\nname = \"foyer\"\nkind = \"quiet\"\npolygon = [[10, 2], [11, 2], [11, 4]]\n"
      "[[zone]]\nname = \"far\"\npolygon = [[80, 2], [81, 2], [81, 4]]\n");
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 6, "overlaps keep-out zone \"stairs\" (line 3)")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 13, "two zones are called \"foyer\"")));
  EXPECT_THAT(findings, Contains(finding(FindingKind::kWarning, 17, "outside the map")));
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::text, HasSubstr("\"beside\" overlaps")))));
  EXPECT_THAT(findings, Not(Contains(Field(&BuildingFinding::text, HasSubstr("quiet zone \"foyer\" overlaps")))));
}

}  // namespace
}  // namespace luminav
