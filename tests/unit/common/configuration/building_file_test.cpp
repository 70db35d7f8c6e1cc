#include "services/common/configuration/building_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/fixture_table.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

const std::string kHead = "name = \"hall\"\nceiling_height = 2.8\n";

std::string refusal_of(const std::string& zone) {
  const TemporaryFolder folder;
  try {
    static_cast<void>(read_building(folder.write("building.toml", kHead + "[[zone]]\n" + zone)));
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

TEST(BuildingFile, KeepsZonesThroughWritingAndReading) {
  const TemporaryFolder folder;
  Building building;
  building.name = "hall";
  building.zones = {{"stairs", ZoneKind::kKeepOut, {{1.0, 2.0}, {3.0, 2.0}, {3.0, 4.5}}, 0.2},
                    {"foyer", ZoneKind::kSlow, {{5.0, 2.0}, {9.0, 2.0}, {9.0, 4.0}, {5.0, 4.0}}, 0.15},
                    {"ramp", ZoneKind::kOneWay, {{1.0, 6.0}, {3.0, 6.0}, {3.0, 8.0}}, 0.2, -1.25},
                    {"ward", ZoneKind::kQuiet, {{5.0, 6.0}, {9.0, 6.0}, {9.0, 8.0}}}};
  building.zones[1].hours = {22 * 3600, 6 * 3600, *read_days("Mo-Fr")};
  building.zones[2].hours = {.days = *read_days("Sa")};
  building.zones[3].hours = {8 * 3600, 12 * 3600 + 1800};
  write_building(folder.path() / "building.toml", building);
  const Building read = read_building(folder.path() / "building.toml");
  ASSERT_EQ(read.zones.size(), building.zones.size());
  for (std::size_t i = 0; i < read.zones.size(); ++i) {
    EXPECT_EQ(read.zones[i].name, building.zones[i].name);
    EXPECT_EQ(read.zones[i].kind, building.zones[i].kind);
    EXPECT_EQ(read.zones[i].polygon, building.zones[i].polygon);
    EXPECT_EQ(read.zones[i].speed, building.zones[i].speed);
    EXPECT_EQ(read.zones[i].direction, building.zones[i].direction);
    EXPECT_EQ(read.zones[i].hours, building.zones[i].hours) << read.zones[i].name;
  }
}

TEST(BuildingFile, RefusesZonesThatAreNoAreas) {
  using testing::HasSubstr;
  const std::string square = "polygon = [[0, 0], [1, 0], [1, 1], [0, 1]]\n";
  EXPECT_EQ(refusal_of("name = \"a\"\n" + square), "");
  EXPECT_THAT(refusal_of("name = \"a\"\npolygon = [[0, 0], [1, 1], [1, 0], [0, 1]]\n"), HasSubstr("do not cross"));
  EXPECT_THAT(refusal_of("name = \"a\"\npolygon = [[0, 0], [1, 1]]\n"), HasSubstr("at least three"));
  EXPECT_THAT(refusal_of("name = \"a\"\npolygon = [[0, 0], [nan, 1], [1, 0]]\n"), HasSubstr("polygon"));
  EXPECT_THAT(refusal_of("name = \"a\"\n"), HasSubstr("polygon"));
  EXPECT_THAT(refusal_of(square), HasSubstr("name"));
  EXPECT_THAT(refusal_of("name = \"a\"\nkind = \"lava\"\n" + square), HasSubstr("kind"));
  EXPECT_THAT(refusal_of("name = \"a\"\nkind = \"slow\"\nspeed = 0\n" + square), HasSubstr("speed"));
  EXPECT_THAT(refusal_of("name = \"a\"\nspeed = 0.2\n" + square), HasSubstr("speed")) << "only slow ones have one";
  EXPECT_THAT(refusal_of("name = \"a\"\nkind = \"one-way\"\n" + square), HasSubstr("direction"));
  EXPECT_THAT(refusal_of("name = \"a\"\nkind = \"quiet\"\ndirection = 0\n" + square), HasSubstr("direction"));
}

TEST(BuildingFile, RefusesHoursOfAZoneThatNoClockShows) {
  using testing::AllOf;
  using testing::HasSubstr;
  const std::string zone = "name = \"a\"\npolygon = [[0, 0], [1, 0], [1, 1]]\n";
  EXPECT_EQ(refusal_of(zone + "hours = \"22:00-06:00\"\ndays = \"Mo, We-Fr\"\n"), "");
  for (const char* hours : {"25:00-26:00", "08:00-08:00", "8 to 12", "", "08:00-12:00-14:00"}) {
    EXPECT_THAT(refusal_of(zone + "hours = \"" + hours + "\"\n"),
                AllOf(HasSubstr("building.toml:6"), HasSubstr("hours"), HasSubstr("two times of day that differ")));
  }
  for (const char* days : {"Monday", "Mo-", ""}) {
    EXPECT_THAT(refusal_of(zone + "days = \"" + days + "\"\n"),
                AllOf(HasSubstr("building.toml:6"), HasSubstr("days"), HasSubstr("as Mo-Fr")));
  }
  EXPECT_THAT(refusal_of(zone + "hours = 8\n"), HasSubstr("hours"));
}

TEST(BuildingFile, SaysHowARobotMaySearch) {
  const TemporaryFolder folder;
  const auto search_of = [&](const std::string& line) {
    return read_building(folder.write("building.toml", kHead + line)).search;
  };
  EXPECT_EQ(search_of(""), SearchManner::kTurn);
  EXPECT_EQ(search_of("search = \"wander\"\n"), SearchManner::kWander);
  EXPECT_EQ(search_of("search = \"turn\"\n"), SearchManner::kTurn);
  EXPECT_EQ(search_of("search = \"stand\"\n"), SearchManner::kStand);
  EXPECT_THROW((void)search_of("search = \"run\"\n"), ConfigurationError);
}

Fixture read_kind(const std::string& text) {
  const TemporaryFolder folder;
  return read_fixture_kind(TomlTable::load(folder.write("fixture.toml", text)), 2.7);
}

TEST(BuildingFile, SaysWhetherAllFixturesAreListed) {
  const TemporaryFolder folder;
  Building building = read_building(folder.write("building.toml", kHead));
  EXPECT_TRUE(building.is_complete);
  building.is_complete = false;
  write_building(folder.path() / "building.toml", building);
  EXPECT_FALSE(read_building(folder.path() / "building.toml").is_complete);
}

TEST(BuildingFile, SaysHowWellASurveyKnowsIt) {
  const TemporaryFolder folder;
  Building building = read_building(folder.write("building.toml", kHead));
  EXPECT_FALSE(building.survey);
  building.survey = SurveyAccuracy{0.025, 0.004};
  building.seen_from = {{1.0, 2.5}, {-3.0, 0.0}};
  write_building(folder.path() / "building.toml", building);
  const Building read = read_building(folder.path() / "building.toml");
  ASSERT_TRUE(read.survey);
  EXPECT_EQ(read.seen_from, building.seen_from);
  building.seen_from = {{1.0, 1e9}};
  write_building(folder.path() / "building.toml", building);
  EXPECT_THROW((void)read_building(folder.path() / "building.toml"), ConfigurationError);
  EXPECT_NEAR(read.survey->position, 0.025, 1e-9);
  EXPECT_NEAR(read.survey->heading, 0.004, 1e-9);
}

TEST(FixtureTable, SaysShapeSizeHeightAndLamps) {
  const Fixture bar = read_kind("length = 1.5\nwidth = 0.3\nlamps = 1\nheight = 2.4\n");
  EXPECT_EQ(bar.shape, FixtureShape::kRectangle);
  EXPECT_DOUBLE_EQ(bar.length, 1.5);
  EXPECT_DOUBLE_EQ(bar.height, 2.4);
  EXPECT_EQ(bar.lamps, 1);
  const Fixture round = read_kind("shape = \"round\"\ndiameter = 0.3\n");
  EXPECT_DOUBLE_EQ(round.width, 0.3);
  EXPECT_DOUBLE_EQ(round.height, 2.7);
}

TEST(FixtureTable, RefusesWhatCannotBe) {
  EXPECT_THROW((void)read_kind("length = 0.3\nwidth = 1.5\n"), ConfigurationError);
  EXPECT_THROW((void)read_kind("shape = \"square\"\nlength = 0.6\nwidth = 0.5\n"), ConfigurationError);
  EXPECT_THROW((void)read_kind("width = 0.3\n"), ConfigurationError);
}

}  // namespace
}  // namespace luminav
