#include "services/common/configuration/building_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
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
                    {"foyer", ZoneKind::kSlow, {{5.0, 2.0}, {9.0, 2.0}, {9.0, 4.0}, {5.0, 4.0}}, 0.15}};
  write_building(folder.path() / "building.toml", building);
  const Building read = read_building(folder.path() / "building.toml");
  ASSERT_EQ(read.zones.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.zones[i].name, building.zones[i].name);
    EXPECT_EQ(read.zones[i].kind, building.zones[i].kind);
    EXPECT_EQ(read.zones[i].polygon, building.zones[i].polygon);
    EXPECT_EQ(read.zones[i].speed, building.zones[i].speed);
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
}

}  // namespace
}  // namespace luminav
