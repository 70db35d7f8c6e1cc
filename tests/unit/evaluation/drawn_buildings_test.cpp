#include "tests/evaluation/runs/drawn/drawn_buildings.hpp"

#include <gtest/gtest.h>

#include <set>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "tests/evaluation/runs/drawn/drawing.hpp"
#include "tests/evaluation/runs/drawn/mishaps.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

TEST(DrawnBuildings, AreEightInWhichASurveyorFindsNoError) {
  const TemporaryFolder folder;
  const auto scenarios = make_drawn_buildings(folder.path());
  EXPECT_EQ(scenarios.size(), 8U);
  for (const auto& file : scenarios) {
    const BuildingSource source = read_building_source(read_scenario(file).building_file);
    const PriorMap map = read_map(source.building.map_file);
    for (const BuildingFinding& finding : check_building(source, &map)) {
      EXPECT_NE(finding.kind, FindingKind::kError) << source.building.name << ": " << finding.text;
    }
  }
}

TEST(Drawing, HangsAGridOfFixturesAtAHeightOfItsOwn) {
  const TemporaryFolder folder;
  Drawing drawing("hall", 12.0, 8.0, 2.8);
  drawing.carve(0.3, 0.3, 11.7, 7.7);
  drawing.build(5.0, 3.0, 6.0, 4.0);
  drawing.hang_grid(FixtureShape::kSquare, {2.0, 2.0, 3.0, 4.0, 3, 2}, 0.6, 0.6, 0.0, 4.2);
  drawing.write(folder.path());
  const Building building = read_building(folder.path() / "building.toml");
  const PriorMap map = read_map(building.map_file);
  ASSERT_EQ(building.fixtures.size(), 6U);
  EXPECT_DOUBLE_EQ(building.fixtures.back().height, 4.2);
  EXPECT_NEAR(distance(building.fixtures.back().world_from_fixture, Pose2{8.0, 6.0, 0.0}), 0.0, 1e-9);
  EXPECT_EQ(map.at({2.0, 2.0}), Prior::kFree);
  EXPECT_EQ(map.at({5.5, 3.5}), Prior::kOccupied);
}

TEST(Mishaps, AreScenariosThatCanBeRead) {
  const TemporaryFolder folder;
  std::set<std::filesystem::path> names;
  for (const auto& file : make_mishaps(folder.path())) {
    EXPECT_FALSE(read_scenario(file).events.empty()) << file;
    names.insert(file.stem());
  }
  EXPECT_EQ(names.size(), 8U);
}

}  // namespace
}  // namespace luminav
