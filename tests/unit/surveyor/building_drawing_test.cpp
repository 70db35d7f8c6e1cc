#include "services/surveyor/building_drawing.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "services/surveyor/floor_plan.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

TEST(BuildingDrawing, ShowsEveryFixtureAndMarksWhatWasFound) {
  const FloorPlan plan = make_floor_plan({.width = 30.0, .depth = 14.0});
  const std::string svg = draw_building_svg(plan.building, &plan.map, {3});
  for (const Fixture& fixture : plan.building.fixtures) {
    EXPECT_NE(svg.find(">" + std::to_string(fixture.id) + "</text>"), std::string::npos);
  }
  const auto marked = svg.find("#f55");
  ASSERT_NE(marked, std::string::npos);
  EXPECT_EQ(svg.find("#f55", marked + 1), std::string::npos);
}

TEST(BuildingDrawing, EscapesNames) {
  Building building;
  building.name = "R&D <lab>";
  EXPECT_NE(draw_building_svg(building, nullptr, {}).find("R&amp;D &lt;lab>"), std::string::npos);
}

TEST(BuildingDrawing, WritesAPictureOrSaysWhyNot) {
  const TemporaryFolder folder;
  const FloorPlan plan = make_floor_plan({});
  draw_building_png(folder.path() / "plan.png", plan.building, &plan.map, {});
  EXPECT_GT(std::filesystem::file_size(folder.path() / "plan.png"), 10'000U);
  EXPECT_ANY_THROW(draw_building_png(folder.path() / "missing" / "plan.png", plan.building, &plan.map, {}));
}

}  // namespace
}  // namespace luminav
