#include "services/surveyor/floor_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

int errors_of(const FloorPlan& plan, const TemporaryFolder& folder) {
  const auto file = folder.path() / "building.toml";
  write_building(file, plan.building);
  const auto findings = check_building(read_building_source(file), &plan.map);
  return static_cast<int>(std::count_if(findings.begin(), findings.end(), [](const BuildingFinding& finding) {
    return finding.kind == FindingKind::kError;
  }));
}

TEST(FloorPlan, PassesTheSurveyorsCheckWhateverItsSizeKindAndSeed) {
  const TemporaryFolder folder;
  for (const auto kind : {FixtureKind::kTubes, FixtureKind::kPanels, FixtureKind::kDownlights, FixtureKind::kMixed}) {
    for (const auto& [width, depth] : {std::pair{14.0, 9.0}, {30.0, 14.0}, {60.0, 40.0}, {130.0, 31.0}}) {
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const FloorPlan plan = make_floor_plan({.width = width,
                                                .depth = depth,
                                                .irregularity = 0.7 * static_cast<double>(seed - 1),
                                                .kind = kind,
                                                .seed = seed});
        EXPECT_EQ(errors_of(plan, folder), 0) << width << " x " << depth << " m, seed " << seed;
        EXPECT_GT(plan.building.fixtures.size(), width * depth / 20.0);
        EXPECT_EQ(plan.building.places.size(), plan.building.doors.size());
      }
    }
  }
}

TEST(FloorPlan, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const FloorPlan first = make_floor_plan({.seed = 5});
  const FloorPlan again = make_floor_plan({.seed = 5});
  const FloorPlan other = make_floor_plan({.seed = 6});
  EXPECT_EQ(first.map.cells, again.map.cells);
  EXPECT_NE(first.map.cells, other.map.cells);
  ASSERT_EQ(first.building.fixtures.size(), again.building.fixtures.size());
  for (std::size_t i = 0; i < first.building.fixtures.size(); ++i) {
    EXPECT_EQ(first.building.fixtures[i].world_from_fixture.x, again.building.fixtures[i].world_from_fixture.x);
  }
}

TEST(FloorPlan, KeepsToThePitchWhenNothingIsIrregular) {
  const FloorPlan plan = make_floor_plan({.width = 30.0, .depth = 14.0, .pitch = 3.0, .irregularity = 0.0});
  std::vector<double> corridor;  // x of the one-lamp fixtures along the only corridor
  for (const Fixture& fixture : plan.building.fixtures) {
    if (fixture.lamps == 1) {
      corridor.push_back(fixture.world_from_fixture.x);
    }
  }
  ASSERT_EQ(corridor.size(), 10U);  // 29.7 m
  for (std::size_t i = 1; i < corridor.size(); ++i) {
    EXPECT_NEAR(corridor[i] - corridor[i - 1], 2.97, 0.002);
  }
}

TEST(FloorPlan, RefusesASizeThatHoldsNoCorridorWithRooms) {
  EXPECT_THROW(make_floor_plan({.width = 60.0, .depth = 5.0}), ConfigurationError);
  EXPECT_THROW(make_floor_plan({.width = 8.0, .depth = 40.0}), ConfigurationError);
}

TEST(LightMap, HangsOneRowInTheMiddleOfACorridorAndNoneInWalls) {
  PriorMap map;
  map.geometry = {.resolution = 0.1, .origin = {0.0, 0.0}, .columns = 300, .rows = 100};
  map.cells.assign(map.geometry.size(), Prior::kOccupied);
  for (int row = 40; row < 60; ++row) {  // 2 m wide from y = 4 to 6
    for (int column = 5; column < 295; ++column) {
      map.cells[map.geometry.index({column, row})] = Prior::kFree;
    }
  }
  const FloorPlan plan = light_map(map, {.pitch = 2.5, .irregularity = 0.0});
  ASSERT_GE(plan.building.fixtures.size(), 10U);
  for (const Fixture& fixture : plan.building.fixtures) {
    EXPECT_NEAR(fixture.world_from_fixture.y, 5.0, 0.11);
    EXPECT_NEAR(fixture.world_from_fixture.theta, 0.0, 1e-9);
    EXPECT_EQ(fixture.lamps, 1);
  }
}

TEST(BuildingFile, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  FloorPlan plan = make_floor_plan({.name = "a \"quoted\" name", .kind = FixtureKind::kMixed});
  plan.building.map_file = "map.yaml";
  write_map(folder.path() / "map.yaml", plan.map);
  write_building(folder.path() / "building.toml", plan.building);
  const BuildingSource source = read_building_source(folder.path() / "building.toml");
  EXPECT_EQ(source.building.name, plan.building.name);
  EXPECT_EQ(source.building.elements.size(), plan.building.elements.size());
  EXPECT_EQ(source.building.windows.size(), plan.building.windows.size());
  ASSERT_EQ(source.building.fixtures.size(), plan.building.fixtures.size());
  ASSERT_EQ(source.fixture_lines.size(), plan.building.fixtures.size());
  for (std::size_t i = 0; i < source.building.fixtures.size(); ++i) {
    EXPECT_EQ(source.building.fixtures[i].shape, plan.building.fixtures[i].shape);
    EXPECT_NEAR(distance(source.building.fixtures[i].world_from_fixture, plan.building.fixtures[i].world_from_fixture),
                0.0, 1e-3);
    EXPECT_GT(source.fixture_lines[i], i == 0 ? 0 : source.fixture_lines[i - 1]);
  }
  EXPECT_EQ(read_map(folder.path() / "map.yaml").cells, plan.map.cells);
}

}  // namespace
}  // namespace luminav
