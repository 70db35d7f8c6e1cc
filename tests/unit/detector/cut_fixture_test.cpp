#include <gtest/gtest.h>

#include <cmath>

#include "services/detector/detector.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"
#include "tests/unit/detector/drawn_detections.hpp"

namespace luminav {
namespace {

using test::detect;
using test::DrawnCeiling;
using test::DrawnShape;
using test::expect_at;

TEST(CutFixture, LeavesOpenWhetherAStripAtTheBorderIsHalfAFixture) {
  for (const DetectionState state : {DetectionState::kLit, DetectionState::kHalf}) {
    DrawnCeiling ceiling;
    ceiling.joint_depth = 20.0;
    const bool half = state == DetectionState::kHalf;
    // burns from 0.88 to 1.03 m ahead; what lies beyond is cut off 1.08 m ahead
    const Pose2 truth{half ? 1.03 : 0.955, 0.1, 0.5 * kPi};
    ceiling.shapes = {{.pose = truth, .width = half ? 0.3 : 0.15, .state = state, .darker = 0.0}};
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U);
    const double sigma = std::sqrt(detections[0].covariance(0, 0));
    EXPECT_LT(std::abs(detections[0].robot_from_fixture.x - truth.x), 2.5 * sigma) << half;
    EXPECT_LT(sigma, 0.05);
  }
}

TEST(CutFixture, SaysOfACutFixtureOnlyWhatIsSeen) {
  DrawnCeiling ceiling;
  const Pose2 truth{0.9, 0.1, 0.2};  // its far end lies beyond the upper border, 1.08 m ahead
  ceiling.shapes = {{.pose = truth}};
  const auto detections = detect(ceiling);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_TRUE(detections[0].clipped);
  EXPECT_TRUE(detections[0].near_end_visible);
  EXPECT_FALSE(detections[0].far_end_visible);
  expect_at(detections[0], truth, 2e-3, radians(0.2));
  EXPECT_LT(detections[0].length, 0.9);
}

TEST(CutFixture, IsSurestOfThePartThatIsSeen) {
  for (const DetectionState state : {DetectionState::kLit, DetectionState::kUnlit}) {
    DrawnCeiling ceiling;
    ceiling.shapes = {{.pose = {0.9, 0.1, 0.0}, .state = state, .darker = 40.0}};  // in view up to x = 1.08 m
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U);
    const Eigen::Matrix3d& covariance = detections[0].covariance;
    const double arm = 0.5 * detections[0].length - 0.6;  // from the centre to the middle of what is seen
    const Eigen::Vector3d across(0.0, 1.0, arm);
    EXPECT_LT(across.dot(covariance * across), 1.3 * covariance(1, 1)) << static_cast<int>(state);
    EXPECT_LT(std::sqrt(covariance(0, 0)), 12e-3) << "one end is seen";
  }
}

TEST(CutFixture, KnowsTheDirectionOfALampAcrossACornerWhereTheLightOfTheCeilingChanges) {
  // Its long sides are seen over different stretches, and its bloom is not as wide over both.
  for (const double turn : {0.20, 0.24, 0.28, 0.32, 0.36}) {
    const Pose2 truth{0.75, -1.05, -turn * kPi};  // the image ends 1.08 m ahead and 1.44 m to the right
    const auto detections = detect({.shapes = {{.pose = truth}}, .slope_x = 45.0, .bloom = 250.0});
    ASSERT_EQ(detections.size(), 1U);
    EXPECT_NEAR(wrap_axis(detections[0].robot_from_fixture.theta - truth.theta), 0.0, radians(0.2)) << turn;
  }
}

TEST(CutFixture, PlacesAFixtureByOneLongSideAndItsEndsWhereTheOtherIsBeyondTheBorder) {
  for (const DetectionState state : {DetectionState::kLit, DetectionState::kUnlit}) {
    DrawnCeiling ceiling;
    const Pose2 truth{0.98, 0.1, 0.5 * kPi + 0.03};  // its outer side lies beyond the upper border, 1.08 m ahead
    ceiling.shapes = {{.pose = truth, .state = state, .darker = 40.0}};
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U);
    EXPECT_TRUE(detections[0].clipped);
    EXPECT_EQ(detections[0].state, state);
    expect_at(detections[0], truth, 10e-3, radians(1.0));
  }
}

TEST(CutFixture, SaysHowFarBloomMayMoveALampOfWhichOneLongSideIsSeen) {
  double squares = 0.0;
  constexpr int kPictures = 8;
  for (std::uint32_t i = 0; i < kPictures; ++i) {
    const Pose2 truth{0.97, 0.1, 0.5 * kPi + 0.01 * (i % 4)};  // its outer side lies beyond the upper border
    const auto detections = detect({.shapes = {{.pose = truth}}, .bloom = 60.0 + 25.0 * i, .seed = i + 1});
    ASSERT_EQ(detections.size(), 1U) << i;
    const double ahead = detections[0].robot_from_fixture.x - truth.x;
    squares += ahead * ahead / detections[0].covariance(0, 0);
  }
  EXPECT_LT(std::sqrt(squares / kPictures), 2.0) << "standard deviations";
}

TEST(CutFixture, FindsTheObliqueEndOfALampBetweenItsSides) {
  for (const double turn : {-0.6, 0.6}) {
    const Pose2 truth{1.40, 0.1, turn};  // of one side less than a quarter of the length is in view
    const auto detections = detect({.shapes = {{.pose = truth}}});
    ASSERT_EQ(detections.size(), 1U) << turn;
    EXPECT_NE(detections[0].near_end_visible, detections[0].far_end_visible) << turn;
    expect_at(detections[0], truth, 5e-3, radians(1.0));
  }
}

TEST(CutFixture, LeavesOutTheSideOfALampWhoseBloomReachesTheBorder) {
  for (const double ahead : {0.910, 0.915, 0.920}) {
    const Pose2 truth{ahead, 0.9, 0.5 * kPi};  // its outer side runs 3 to 4 px from the upper border
    const auto detections = detect({.shapes = {{.pose = truth}}, .bloom = 160.0});
    ASSERT_EQ(detections.size(), 1U) << ahead;
    const double sigma = std::sqrt(detections[0].covariance(0, 0));
    EXPECT_LT(std::abs(detections[0].robot_from_fixture.x - truth.x), 2.0 * sigma) << ahead;
    EXPECT_LT(sigma, 0.03) << ahead;
  }
}

/// One of its ends is in view, and it is where the truth is within what it says of itself.
void expect_by_one_end(const Detection& detection, const Pose2& truth) {
  EXPECT_NE(detection.near_end_visible, detection.far_end_visible);
  const Pose2& found = detection.robot_from_fixture;
  EXPECT_LT(std::abs(found.x - truth.x), 2.5 * std::sqrt(detection.covariance(0, 0)));
  EXPECT_LT(std::abs(found.y - truth.y), 2.5 * std::sqrt(detection.covariance(1, 1)));
}

TEST(CutFixture, LeavesOutTheEndOfALampWhoseBloomReachesTheBorder) {
  for (const double aside : {0.860, 0.864, 0.868}) {
    const Pose2 truth{0.98, aside,
                      0.5 * kPi};  // its outer side is beyond the upper border, its far end at the left one
    const auto detections = detect({.shapes = {{.pose = truth}}, .bloom = 160.0});
    ASSERT_EQ(detections.size(), 1U) << aside;
    expect_by_one_end(detections[0], truth);
    EXPECT_LT(std::sqrt(detections[0].covariance(1, 1)), 0.035) << aside;
  }
}

TEST(CutFixture, KnowsALampByHowDeepItIsWhereBothItsEndsSayHowFarItsBloomReaches) {
  for (const double bloom : {80.0, 160.0}) {
    const Pose2 truth{bloom > 100.0 ? 1.075 : 1.085, 0.1, 0.5 * kPi};  // little more than half of it is in view
    const auto detections = detect({.shapes = {{.pose = truth}}, .bloom = bloom});
    ASSERT_EQ(detections.size(), 1U) << bloom;
    expect_at(detections[0], truth, 10e-3, radians(0.3));
    for (const double ahead : {1.04, 1.06, 1.08, 1.10}) {  // the same of which only the half in view burns
      const DrawnShape half{
          .pose = {ahead, 0.1, 0.5 * kPi}, .state = DetectionState::kHalf, .darker = -20.0, .half_bloom = bloom};
      for (const Detection& detection : detect({.shapes = {half}})) {
        EXPECT_LT(detection.width, 0.25) << bloom << ", " << ahead;
      }
    }
  }
}

TEST(CutFixture, TakesNoLampForAHalfByAJointThatIsSeenBesideOneSideOnly) {
  DrawnCeiling ceiling;
  ceiling.joint_depth = 20.0;
  for (const Pose2& truth : {Pose2{1.02, 0.30, 0.02}, Pose2{1.12, 0.17, 0.02}, Pose2{1.24, 0.17, 0.02}}) {
    ceiling.shapes = {{.pose = truth, .width = 0.15}};  // the border cuts a joint off nearer on one side of it
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U) << truth.x;
    EXPECT_EQ(detections[0].state, DetectionState::kLit) << truth.x;
    expect_at(detections[0], truth, 5e-3, radians(0.2));
  }
}

TEST(CutFixture, TakesNoLampForAHalfByJointsThatRunObliquely) {
  const std::vector<Pose2> truths{{-1.00, 0.02, radians(-67.0)},
                                  {1.09, -0.25, radians(68.0)},
                                  {-0.35, 0.48, radians(-61.0)},
                                  {0.20, 0.32, radians(-31.0)}};
  for (const Pose2& truth : truths) {
    const auto detections = detect({.shapes = {{.pose = truth, .width = 0.15}}, .joint_depth = 20.0, .bloom = 40.0});
    ASSERT_EQ(detections.size(), 1U) << truth.x;
    EXPECT_EQ(detections[0].state, DetectionState::kLit) << truth.x;
  }
}

TEST(CutFixture, TakesNoEndOfALampForTheSideOfOneAcrossIt) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.length = 1.2, .width = 0.3, .lamps = 2},
                        {.shape = FixtureShape::kSquare, .length = 0.6, .width = 0.6, .lamps = 1}};
  // its end is in view, and the border cuts it lengthwise: 1.08 m behind, 1.44 m to the right
  const Pose2 truth{-0.94, -1.75, radians(-85.0)};
  const DrawnCeiling ceiling{.shapes = {{.pose = truth}}, .joint_depth = 20.0, .bloom = 160.0};
  for (const Detection& detection : detect(ceiling, test::test_camera(), catalogue)) {
    EXPECT_EQ(detection.shape, FixtureShape::kRectangle);
    EXPECT_LT(std::abs(wrap_axis(detection.robot_from_fixture.theta - truth.theta)), 0.1);
  }
}

TEST(CutFixture, LeavesOutAPieceThatIsNoDeeperThanANarrowerFixture) {
  DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {1.13, 0.1, 0.5 * kPi}}};  // 0.1 m of it is in view, and fixtures of 0.15 m are listed
  EXPECT_TRUE(detect(ceiling).empty());
}

TEST(CutFixture, TakesNoStripBesideTheBorderForTheSideOfAPanel) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.length = 1.5, .width = 0.2, .lamps = 1},
                        {.shape = FixtureShape::kSquare, .length = 1.0, .width = 1.0, .lamps = 1}};
  // the image ends 1.08 m ahead and 1.44 m to the left
  for (const Pose2& truth : {Pose2{-0.75, 1.30, 0.0}, Pose2{0.6, 1.32, 0.0}, Pose2{0.9, 1.32, 0.0}}) {
    const DrawnCeiling ceiling{.shapes = {{.pose = truth, .length = 1.5, .width = 0.2}}, .bloom = 400.0};
    for (const Detection& detection : detect(ceiling, test::test_camera(), catalogue)) {
      EXPECT_EQ(detection.shape, FixtureShape::kRectangle) << truth.x;
    }
  }
}

TEST(CutFixture, LeavesTheCentreOpenWhenNoEndIsSeen) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.length = 3.0, .width = 0.3, .height = 2.8, .lamps = 2}};
  DrawnCeiling ceiling;
  const Pose2 truth{0.3, 0.1, 0.0};
  ceiling.shapes = {{.pose = truth, .length = 3.0}};
  const auto detections = detect(ceiling, test::test_camera(), catalogue);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_FALSE(detections[0].near_end_visible);
  EXPECT_FALSE(detections[0].far_end_visible);
  EXPECT_GT(detections[0].covariance(0, 0), 0.065) << "0.84 m are out of view";
  EXPECT_LT(detections[0].covariance(1, 1), 1e-5);
  EXPECT_NEAR(detections[0].robot_from_fixture.y, truth.y, 2e-3);
}

TEST(CutFixture, LeavesTheCentreOpenWhenALongerKindLooksLikeIt) {
  const Pose2 truth{0.85, 0.1, 0.0};  // in view from x = 0.4 to 1.08 m
  const DrawnCeiling ceiling{.shapes = {{.pose = truth, .length = 0.9, .width = 0.15}}};
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.length = 0.9, .width = 0.15, .lamps = 1}};
  const auto one_kind = detect(ceiling, test::test_camera(), catalogue);
  ASSERT_EQ(one_kind.size(), 1U);
  EXPECT_TRUE(one_kind[0].near_end_visible);
  expect_at(one_kind[0], truth, 10e-3, radians(0.3));
  catalogue.fixtures.push_back({.length = 1.5, .width = 0.17, .lamps = 1});  // bloom makes the other one as wide
  const auto two_kinds = detect(ceiling, test::test_camera(), catalogue);
  ASSERT_EQ(two_kinds.size(), 1U);
  EXPECT_FALSE(two_kinds[0].near_end_visible);
  EXPECT_LT(std::abs(two_kinds[0].robot_from_fixture.x - truth.x), 2.0 * std::sqrt(two_kinds[0].covariance(0, 0)));
  EXPECT_NEAR(two_kinds[0].robot_from_fixture.y, truth.y, 10e-3);
}

TEST(CutFixture, TellsACutFixtureFromACutVentByItsSmoothSurface) {
  CeilingCatalogue catalogue = test::test_catalogue();
  for (CeilingKind& element : catalogue.elements) {
    element.slatted = true;
  }
  struct Case {
    double noise;
    double darker;
  };
  for (const Case& c : {Case{8.0, 30.0}, Case{7.0, 12.0}}) {
    DrawnCeiling ceiling;
    ceiling.noise = c.noise;
    // what is in view of it may be as long as a vent
    const DrawnShape fixture{.pose = {1.2, 0.1, 0.1}, .state = DetectionState::kUnlit, .darker = c.darker};
    ceiling.shapes = {fixture};
    const auto found = detect(ceiling, test::test_camera(), catalogue);
    ASSERT_EQ(found.size(), 1U) << c.darker;
    EXPECT_EQ(found[0].shape, FixtureShape::kRectangle);
    EXPECT_NEAR(found[0].robot_from_fixture.y, fixture.pose.y, 5e-3);
    DrawnShape vent{.pose = {0.95, 0.1, 0.1}, .length = 0.6, .state = DetectionState::kUnlit, .darker = c.darker};
    vent.slats = 0.5 * c.darker;
    ceiling.shapes = {vent};
    EXPECT_TRUE(detect(ceiling, test::test_camera(), catalogue).empty()) << c.darker;
  }
}

TEST(CutFixture, TakesNoStripWithoutAnEndForAnUnlitFixture) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.length = 3.2, .width = 0.3, .height = 2.8, .lamps = 1}};
  for (const Pose2& pose : {Pose2{0.1, 0.0, 0.5 * kPi}, Pose2{0.97, 0.1, 0.5 * kPi + 0.02}}) {
    DrawnCeiling ceiling;
    ceiling.shapes = {{.pose = pose, .length = 3.2, .state = DetectionState::kUnlit, .darker = 40.0}};
    EXPECT_TRUE(detect(ceiling, test::test_camera(), catalogue).empty()) << "grooves and beams look like it";
  }
}

}  // namespace
}  // namespace luminav
