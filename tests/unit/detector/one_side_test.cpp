#include "services/detector/one_side.hpp"

#include <gtest/gtest.h>

#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

using test::DrawnCeiling;

/// What is said of a lamp that is taken for one of 0.3 m by the edge of its left side, which is 22 mm outside of it.
bool may_be_another(double width) {
  constexpr double kBloom = 0.022;  // [m]
  constexpr int kFactor = 4;
  const CameraDescription description = test::test_camera();
  const CeilingCamera camera(description.intrinsics, description.mounting);
  const CeilingCatalogue catalogue = test::test_catalogue();
  const DrawnCeiling ceiling{.shapes = {{.pose = {0.3, 0.0, 0.0}, .width = width}}, .bloom = 300.0};
  const GreyImage image = test::draw_ceiling(ceiling, description, catalogue.ceiling_height);
  const GreyView view = image.view();
  Raster reduced;
  reduce(view, kFactor, reduced);
  const CeilingFrame frame{.image = view, .reduced = reduced, .dark = reduced, .factor = kFactor};
  Candidate candidate;
  candidate.hypothesis.outline = {FixtureShape::kRectangle, 1.2, 0.3, catalogue.ceiling_height};
  candidate.fit.robot_from_outline = {0.3, 0.5 * width + kBloom - 0.15, 0.0};
  candidate.fit.visible_from = -0.5;
  candidate.fit.visible_to = 0.5;
  candidate.fit.metres_per_px = 0.0045;
  return PieceFromOneSide(frame, camera, candidate, kLeftSide, true).may_be_another(catalogue);
}

TEST(PieceFromOneSide, IsNoWiderLampWhereTheCeilingShowsBeforeItsOtherSide) {
  EXPECT_FALSE(may_be_another(0.3));
  EXPECT_TRUE(may_be_another(0.15)) << "bloom makes it look 44 mm wider";
}

}  // namespace
}  // namespace luminav
