#include "services/localizer/model/wall_field.hpp"

#include <gtest/gtest.h>

#include <string>

namespace luminav {
namespace {

/// '#' wall, '.' free, ' ' unknown; the first line is the top; cells of 0.1 m.
PriorMap drawn(const std::vector<std::string>& lines) {
  PriorMap map;
  map.geometry = {0.1, {0.0, 0.0}, static_cast<int>(lines.front().size()), static_cast<int>(lines.size())};
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    for (const char c : *line) {
      map.cells.push_back(c == '#' ? Prior::kOccupied : c == '.' ? Prior::kFree : Prior::kUnknown);
    }
  }
  return map;
}

TEST(WallField, MeasuresToTheCentreOfTheNearestWallCell) {
  const WallField field(drawn({"#.....", "#.....", "#....."}));
  EXPECT_NEAR(field.distance_to_wall({0.35, 0.15}), 0.3, 0.011);
  EXPECT_NEAR(field.distance_to_wall({0.30, 0.15}), 0.25, 0.011);
  EXPECT_EQ(field.distance_to_wall({0.05, 0.15}), 0.0);
}

TEST(WallField, KnowsFreeFromUnknownAndOutside) {
  const WallField field(drawn({"#. ", "#. "}));
  EXPECT_TRUE(field.is_free({0.15, 0.05}));
  EXPECT_FALSE(field.is_free({0.25, 0.05}));
  EXPECT_FALSE(field.is_free({0.05, 0.05}));
  EXPECT_FALSE(field.is_free({-5.0, 0.0}));
  EXPECT_EQ(field.distance_to_wall({-5.0, 0.0}), WallField::kFarthest);
}

TEST(WallField, TracesToAWallAndNoFurtherThanTheLimit) {
  const WallField field(drawn({"....................#", "....................#", "....................#"}));
  EXPECT_NEAR(field.range_to_wall({0.15, 0.15}, {1.0, 0.0}, 5.0), 1.85, 0.06);
  EXPECT_EQ(field.range_to_wall({0.15, 0.15}, {1.0, 0.0}, 1.0), 1.0);
}

TEST(WallField, WithoutAMapEverythingIsFree) {
  const WallField field;
  EXPECT_FALSE(field.has_walls());
  EXPECT_TRUE(field.is_free({1e6, -1e6}));
  EXPECT_EQ(field.distance_to_wall({0.0, 0.0}), WallField::kFarthest);
}

}  // namespace
}  // namespace luminav
