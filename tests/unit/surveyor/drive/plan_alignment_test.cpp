#include "services/surveyor/drive/plan_alignment.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/building_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// A plan of walls around and between rooms: x0, y0, x1, y1 [m] of each.
PriorMap drawn(const std::vector<std::array<double, 4>>& walls, const Eigen::Vector2d& size) {
  PriorMap map;
  map.geometry = {0.1, {0.0, 0.0}, static_cast<int>(10.0 * size.x()), static_cast<int>(10.0 * size.y())};
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (const auto& [x0, y0, x1, y1] : walls) {
    const double length = std::max(std::hypot(x1 - x0, y1 - y0), 0.1);
    for (double along = 0.0; along <= length; along += 0.05) {
      const Cell cell = map.geometry.cell_at({x0 + (x1 - x0) * along / length, y0 + (y1 - y0) * along / length});
      if (map.geometry.contains(cell)) {
        map.cells[map.geometry.index(cell)] = Prior::kOccupied;
      }
    }
  }
  return map;
}

const std::vector<std::array<double, 4>> kRooms = {{1.0, 1.0, 15.0, 1.0}, {15.0, 1.0, 15.0, 9.0}, {15.0, 9.0, 1.0, 9.0},
                                                   {1.0, 9.0, 1.0, 1.0},  {6.0, 1.0, 6.0, 5.5},   {6.0, 6.5, 6.0, 9.0},
                                                   {6.0, 4.0, 12.0, 4.0}, {10.0, 6.0, 10.0, 9.0}};

/// The map as a survey has it whose frame lies at `plan_from_survey`.
PriorMap seen_from(const PriorMap& plan, const Pose2& plan_from_survey) {
  PriorMap map;
  map.geometry = {0.1, {-20.0, -20.0}, 400, 400};
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      map.cells.push_back(plan.at(plan_from_survey * map.geometry.centre_of({column, row})));
    }
  }
  return map;
}

/// A survey of a robot that drove from (2, 2) to (5, 8) on the plan.
Survey driven(const Pose2& plan_from_survey) {
  Survey survey;
  for (double share = 0.0; share <= 1.0; share += 0.02) {
    survey.estimate.poses.push_back(plan_from_survey.inverse() * Pose2{2.0 + 3.0 * share, 2.0 + 6.0 * share, 1.1});
  }
  return survey;
}

TEST(PlanAlignment, FindsAPlanThatLiesTurnedInAnyDirection) {
  const PriorMap plan = drawn(kRooms, {16.0, 10.0});
  for (const double theta : {0.02, 0.5 * kPi, kPi - 0.03, -0.5 * kPi}) {
    const Pose2 plan_from_survey{5.0, 4.0, wrap_angle(theta)};
    const auto found = align_with_walls(driven(plan_from_survey), seen_from(plan, plan_from_survey), plan);
    ASSERT_TRUE(found) << theta;
    EXPECT_LT(distance(*found, plan_from_survey), 0.1) << theta;
    EXPECT_LT(std::abs(wrap_angle(found->theta - theta)), 0.02) << theta;
  }
}

TEST(PlanAlignment, DoesNotChooseBetweenTheEndsOfASymmetricRoom) {
  const PriorMap plan =
      drawn({{1.0, 1.0, 9.0, 1.0}, {9.0, 1.0, 9.0, 5.0}, {9.0, 5.0, 1.0, 5.0}, {1.0, 5.0, 1.0, 1.0}}, {10.0, 6.0});
  Survey survey;
  survey.estimate.poses = {{2.0, 3.0, 0.0}, {8.0, 3.0, 0.0}};
  EXPECT_FALSE(align_with_walls(survey, plan, plan));
}

TEST(PlanAlignment, DoesNotFitAPlanOfAnotherBuildingNorOneToAnotherScale) {
  const PriorMap plan = drawn(kRooms, {16.0, 10.0});
  const PriorMap other = drawn({{1.0, 1.0, 4.0, 1.0}, {4.0, 1.0, 8.0, 5.0}, {2.0, 9.0, 14.0, 7.5}}, {16.0, 10.0});
  EXPECT_FALSE(align_with_walls(driven({}), plan, other));
  PriorMap larger = plan;
  larger.geometry.resolution = 0.11;
  EXPECT_FALSE(align_with_walls(driven({}), plan, larger));
  PriorMap nothing = plan;
  nothing.cells.assign(nothing.cells.size(), Prior::kUnknown);
  EXPECT_FALSE(align_with_walls(driven({}), nothing, plan));
}

TEST(PlanAlignment, LaysASurveyOnABuildingByItsFixtures) {
  const TemporaryFolder folder;
  const Pose2 file_from_survey{10.0, 5.0, 2.0};
  const SurveyModel model = synthetic_model();
  Building building;
  building.name = "school";
  Survey survey;
  survey.estimate.poses = {{0.0, 0.0, 0.0}};
  for (int i = 0; i < 9; ++i) {
    const Pose2 at{2.3 * (i % 3) + 0.4 * std::sin(3.0 * i), 2.8 * (i / 3), i % 2 == 0 ? 0.0 : 0.5 * kPi};
    survey.estimate.fixtures.push_back({0, {}, at});
    building.fixtures.push_back(model.kinds.kinds[0]);
    building.fixtures.back().id = i;
    building.fixtures.back().world_from_fixture = file_from_survey * at;
  }
  write_building(folder.path() / "building.toml", building);
  const auto found = align_with_fixtures(survey, model, folder.path() / "building.toml");
  ASSERT_TRUE(found);
  EXPECT_LT(distance(*found, file_from_survey), 0.01);
  EXPECT_NEAR(found->theta, 2.0, 0.01);
  survey.estimate.fixtures.resize(3);
  EXPECT_FALSE(align_with_fixtures(survey, model, folder.path()));
}

}  // namespace
}  // namespace luminav
