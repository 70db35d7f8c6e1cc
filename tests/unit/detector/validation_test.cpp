#include <gtest/gtest.h>

#include "services/detector/sampling/mean_profile.hpp"
#include "services/detector/sampling/pixel_sampling.hpp"
#include "services/detector/sampling/raster.hpp"
#include "services/detector/validation/candidate.hpp"
#include "services/detector/validation/candidate_checks.hpp"
#include "services/detector/validation/candidate_selection.hpp"
#include "services/detector/validation/detection_builder.hpp"
#include "services/detector/validation/half_lit.hpp"
#include "services/detector/validation/other_kinds.hpp"
#include "services/detector/validation/verdict.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"
#include "tests/unit/detector/drawn_detections.hpp"

namespace luminav {
namespace {

constexpr double kHeight = 2.8;

CeilingCamera model() {
  const CameraDescription camera = test::test_camera();
  return CeilingCamera(camera.intrinsics, camera.mounting);
}

/// One of two lamps burns, that towards +y.
GreyImage half_lit(double joint_depth, double darker) {
  test::DrawnCeiling ceiling{.joint_depth = joint_depth, .noise = 1.0};
  ceiling.shapes = {{.pose = {0.05, 0.1, 0.0}, .state = DetectionState::kHalf, .darker = darker}};
  return test::draw_ceiling(ceiling, test::test_camera(), kHeight);
}
const Outline kStrip{.length = 1.2, .width = 0.15, .height = kHeight};
const OutlinePlacement kBurningHalf{.pose = {0.05, 0.175, 0.0}};

/// It has an edge wherever one was looked for.
Candidate candidate_of(const Pose2& pose, double width) {
  Candidate candidate;
  candidate.hypothesis.outline = {.length = 1.2, .width = width, .height = kHeight};
  candidate.fit.placement.pose = pose;
  candidate.fit.metres_per_px = 0.0045;
  candidate.fit.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  candidate.fit.visible_from = -0.6;
  candidate.fit.visible_to = 0.6;
  candidate.fit.sides.fill({.expected = 20, .in_view = 20, .on_edge = 20, .step = 5.0});
  return candidate;
}

TEST(Verdict, HasAText) {
  EXPECT_STREQ(to_string(Verdict::kAccepted), "accepted");
  EXPECT_STREQ(to_string(Verdict::kMayBeAnother), "may be another kind");
}

TEST(HalfLit, IsDarkOnTheSideWhereItIsDarkerThanFartherOut) {
  EXPECT_EQ(find_darker_side(half_lit(0.0, 40.0).view(), model(), kStrip, kBurningHalf, 0.15, 1.0), -1);
  EXPECT_EQ(find_darker_side(half_lit(0.0, 0.0).view(), model(), kStrip, kBurningHalf, 0.15, 1.0), 0);
}

TEST(HalfLit, IsDarkOnTheSideInViewWhereTheImageEndsBesideTheOther) {
  test::DrawnCeiling ceiling{.joint_depth = 20.0, .noise = 1.0};
  const Pose2 pose{0.05, 0.66, 0.0};  // the burning half ends where the view does
  ceiling.shapes = {{.pose = pose, .state = DetectionState::kHalf, .darker = 40.0, .slats = 30.0}};
  const OutlinePlacement burning{.pose = {0.05, 0.735, 0.0}};
  const GreyImage image = test::draw_ceiling(ceiling, test::test_camera(), kHeight);
  EXPECT_EQ(find_darker_side(image.view(), model(), kStrip, burning, 0.15, 1.0), -1);
}

TEST(HalfLit, ShowsADarkHalfAsBrightAsTheCeilingByTheGridThatItCovers) {
  EXPECT_EQ(find_covered_side(half_lit(20.0, 0.0).view(), model(), kStrip, kBurningHalf, 1.0), -1);
}

TEST(MeanProfile, CrossesAnEdge) {
  const SideLine side{{0.05, 0.175, 0.0}, kHeight, Eigen::Vector2d::UnitX(), Eigen::Vector2d::UnitY()};
  const SideProfile profile = mean_profile(half_lit(0.0, 0.0).view(), model(), side,
                                           {.first = 0.0, .steps = 40, .from = -0.3, .apart = 0.04, .count = 16});
  EXPECT_EQ(profile.lines, 16);
  EXPECT_NEAR(profile.grey.front(), 255.0, 1.0);
  EXPECT_NEAR(profile.grey.back(), 110.0, 3.0);
}

TEST(PixelSampling, IsLinearBetweenPixels) {
  const GreyImage image{4, 4, {0, 0, 0, 0, 0, 10, 30, 0, 0, 50, 70, 0, 0, 0, 0, 0}};
  EXPECT_FLOAT_EQ(bilinear(image.view(), 1.5F, 1.0F), 20.0F);
  EXPECT_FLOAT_EQ(bilinear(image.view(), 1.5F, 1.5F), 40.0F);
  EXPECT_TRUE(is_sampled(image.view(), {1.5, 1.5}));
  EXPECT_FALSE(is_sampled(image.view(), {2.5, 1.5}));
}

// A tile of the ceiling has lines all round, too, that pass for edges.
TEST(CandidateChecks, TakeNothingForUnlitThatIsAsDarkAsTheCeilingAroundIt) {
  const CandidateChecks checks({}, model(), test::test_catalogue());
  for (const double darker : {2.0, 12.0}) {
    const Pose2 pose{0.1, 0.05, 0.3};
    const GreyImage image = test::draw_ceiling(
        {.shapes = {{.pose = pose, .state = DetectionState::kUnlit, .darker = darker}}, .noise = 1.0},
        test::test_camera(), kHeight);
    Candidate candidate = candidate_of(pose, 0.3);
    candidate.bright = false;
    const Raster cells = raster_of(image.view());
    const CeilingFrame frame{.image = image.view(), .reduced = cells, .dark = cells, .factor = 1, .pixel_noise = 1.0};
    EXPECT_EQ(checks.by_edges(frame, candidate) == Verdict::kNoContrast, darker < 5.0) << darker;
  }
}

TEST(CandidateChecks, TakeARaggedRegionThatHasEdgesAllRoundForALamp) {
  const CandidateChecks checks({}, model(), test::test_catalogue());
  const Pose2 pose{0.1, 0.05, 0.3};
  const GreyImage image =
      test::draw_ceiling({.shapes = {{.pose = pose, .width = 0.15}}, .bloom = 0.0}, test::test_camera(), kHeight);
  Raster cells;
  reduce(image.view(), 2, cells);
  const CeilingFrame frame{.image = image.view(), .reduced = cells, .dark = cells, .factor = 2, .brightest = 255};
  Candidate candidate = candidate_of(pose, 0.15);
  candidate.level = 250;
  candidate.bright = true;
  candidate.hypothesis.is_whole = true;
  candidate.hypothesis.fill = 0.5;
  EXPECT_EQ(checks.by_edges(frame, candidate), Verdict::kAccepted);
  candidate.fit.sides[kFarEnd].on_edge = 19;
  EXPECT_EQ(checks.by_edges(frame, candidate), Verdict::kMuchAmiss);
  candidate.fit.sides[kFarEnd].on_edge = 20;
  candidate.by_edges = false;
  EXPECT_EQ(checks.by_region(frame, candidate), Verdict::kMuchAmiss);
}

TEST(CandidateChecks, FindALampWhoseSizeTheFileHasWrongByATenth) {
  for (const double factor : {0.91, 1.0, 1.09}) {
    test::DrawnCeiling ceiling;
    ceiling.shapes = {{.pose = {0.1, 0.05, 0.4}, .length = 1.2 * factor, .width = 0.15 * factor}};
    const auto detections = test::detect(ceiling);
    ASSERT_EQ(detections.size(), 1U) << factor;
    test::expect_at(detections[0], {0.1, 0.05, 0.4}, 5e-3, radians(0.2));
  }
}

TEST(CandidateChecks, TakeNoPanesOfASkylightForLamps) {
  test::DrawnCeiling ceiling;
  for (int i = -2; i <= 2; ++i) {
    ceiling.shapes.push_back({.pose = {0.0, 0.19 * i, 0.0}, .width = 0.15});
  }
  ceiling.bloom = 10.0;
  for (const Detection& detection : test::detect(ceiling)) {
    EXPECT_GT(std::abs(detection.robot_from_fixture.y), 0.3) << "one between others";
  }
}

TEST(DetectionBuilder, DescribesAWholeLamp) {
  const CeilingCatalogue catalogue{.fixtures = {{.length = 1.2, .width = 0.15, .lamps = 1}}, .elements = {}};
  const DetectionBuilder builder(model(), catalogue, 0.07);
  Candidate candidate;
  candidate.hypothesis.outline = kStrip;
  candidate.fit.placement = kBurningHalf;
  candidate.by_edges = false;
  const GreyImage image = half_lit(0.0, 0.0);
  Raster reduced;
  reduce(image.view(), 4, reduced);
  const auto detection = builder.build({.image = image.view(), .reduced = reduced, .dark = reduced}, candidate);
  ASSERT_TRUE(detection);
  EXPECT_EQ(detection->state, DetectionState::kLit);
  EXPECT_FALSE(detection->clipped);
  EXPECT_DOUBLE_EQ(detection->length, 1.2);
  EXPECT_DOUBLE_EQ(detection->robot_from_fixture.y, 0.175);
}

TEST(CandidateSelection, TakesTheBestOfThoseThatClaimAPlace) {
  const CeilingCatalogue catalogue{.fixtures = {{.length = 1.2, .width = 0.15, .lamps = 1}}, .elements = {}};
  CandidateSelection selection(model(), catalogue, 0.07);
  const GreyImage image = half_lit(0.0, 0.0);
  Raster reduced;
  reduce(image.view(), 4, reduced);
  selection.begin_frame();
  for (const double y : {0.175, 0.2, 0.6}) {
    Candidate candidate;
    candidate.hypothesis.outline = kStrip;
    candidate.fit.placement.pose = {0.05, y, 0.0};
    candidate.by_edges = false;
    candidate.score = y;
    selection.add(candidate);
  }
  EXPECT_FALSE(selection.explains({0.05, 0.2})) << "a better one may come";
  selection.take_best_first({.image = image.view(), .reduced = reduced, .dark = reduced});
  ASSERT_EQ(selection.detections().size(), 2U);
  EXPECT_DOUBLE_EQ(selection.detections()[0].robot_from_fixture.y, 0.6);
  EXPECT_DOUBLE_EQ(selection.detections()[1].robot_from_fixture.y, 0.2);
  EXPECT_TRUE(selection.explains({0.05, 0.2}));
  EXPECT_FALSE(selection.explains({0.05, 0.35}));
  selection.begin_frame();
  EXPECT_TRUE(selection.detections().empty());
}

}  // namespace
}  // namespace luminav
