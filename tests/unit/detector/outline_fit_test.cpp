#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "services/detector/bloom_edges.hpp"
#include "services/detector/bloom_symmetry.hpp"
#include "services/detector/opposite_sides.hpp"
#include "services/detector/outline_edges.hpp"
#include "services/detector/outline_fit.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

constexpr double kHeight = 2.8;

TEST(OutlineFitter, FindsTheOutlineFromANearbyStartToATenthOfAPixel) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const Pose2 truth{0.2, -0.1, 0.4};
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = truth}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  OutlineFitter fitter(model);
  const auto fit = fitter.fit(image.view(), {.length = 1.2, .width = 0.3, .height = kHeight}, {},
                              {truth.x + 0.02, truth.y - 0.015, truth.theta + 0.02});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->robot_from_outline.x, truth.x, 0.45e-3);  // 4.5 mm per pixel
  EXPECT_NEAR(fit->robot_from_outline.y, truth.y, 0.45e-3);
  EXPECT_NEAR(fit->robot_from_outline.theta, truth.theta, radians(0.05));
  EXPECT_GT(fit->quality(), 0.95);
  EXPECT_TRUE(fit->end_visible(kFarEnd));
  EXPECT_TRUE(fit->end_visible(kNearEnd));
}

TEST(OutlineFitter, LeavesThePlaceAlongAnEndlessStripUncertain) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {0.0, 0.0, 0.0}, .length = 6.0}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  OutlineFitter fitter(model);
  const auto fit = fitter.fit(image.view(), {.length = 6.0, .width = 0.3, .height = kHeight}, {}, {0.0, 0.01, 0.01});
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->end_visible(kFarEnd));
  EXPECT_FALSE(fit->end_visible(kNearEnd));
  EXPECT_GT(fit->covariance(0, 0), 0.1);
  EXPECT_LT(fit->covariance(1, 1), 1e-6);
}

TEST(OutlineFitter, RefusesAPlaceWithoutEdges) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const GreyImage image = test::draw_ceiling({}, camera, kHeight);
  OutlineFitter fitter(model);
  EXPECT_FALSE(fitter.fit(image.view(), {.length = 1.2, .width = 0.3, .height = kHeight}, {}, {0.0, 0.0, 0.0}));
}

TEST(OutlineEdges, LooksAtNoMorePointsThanItIsTold) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  const Outline outline{.length = 1.2, .width = 0.3, .height = kHeight};
  OutlineEdges edges(model);
  edges.place(outline, 0.0045, 6.0, true);
  EdgeSearch search{.search_px = 6, .half_filter = 4, .lines = 1, .least_edge = 10.0, .last_side = kLeftSide};
  edges.measure(image.view(), outline, {}, {}, search);
  const std::span<const OutlinePoint> points = edges.points_of(kLeftSide);
  const std::vector<OutlinePoint> all(points.begin(), points.end());
  ASSERT_EQ(edges.count_in_view(kLeftSide), static_cast<std::ptrdiff_t>(all.size()));
  search.every = 3;
  edges.measure(image.view(), outline, {}, {}, search);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(points[i].found, i % 3 == 1) << i;
    EXPECT_EQ(points[i].in_view, i % 3 == 1) << i;
    if (points[i].found) {
      EXPECT_EQ(points[i].offset_px, all[i].offset_px) << i;
    }
  }
}

/// A lamp whose bloom has been levelled.
struct LevelledLamp {
  CameraDescription camera = test::test_camera();
  CeilingCamera model{camera.intrinsics, camera.mounting};
  Pose2 truth;
  Outline outline;
  OutlineFitParams params{.swelling_sigma = 0.02, .vignetting = 0.0};
  GreyImage image;
  OutlineFit fit;

  LevelledLamp(test::DrawnCeiling ceiling, const Pose2& lamp, double width)
      : truth(lamp), outline{.length = 1.2, .width = width, .height = kHeight} {
    ceiling.shapes = {{.pose = truth, .width = width}};
    image = test::draw_ceiling(ceiling, camera, kHeight);
    level();
  }
  void level() {
    const auto found = OutlineFitter(model).fit(image.view(), outline, params, truth);
    EXPECT_TRUE(found);
    fit = found.value_or(OutlineFit{});
    level_bloom(image.view(), model, outline, params, fit);
  }
  void balance() { balance_bloom(image.view(), model, outline, params, fit); }
  /// Any grey levels beyond its far end's bloom.
  void clutter_far_end() {
    std::mt19937 rng(5);
    std::uniform_int_distribution<int> grey(60, 200);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const auto place = model.point_on_ceiling({x, y}, kHeight);
        const Eigen::Vector2d beyond = truth.inverse() * place.value_or(Eigen::Vector2d::Zero());
        if (beyond.x() > 0.5 * outline.length + 0.03 && std::abs(beyond.y()) < outline.width) {
          image.pixels[static_cast<std::size_t>(y * image.width + x)] = static_cast<std::uint8_t>(grey(rng));
        }
      }
    }
    level();
  }
  [[nodiscard]] Pose2 error() const { return truth.inverse() * fit.robot_from_outline; }
};

constexpr double kSaturatedBloom = 250.0;     // [grey] at the lamp's edge
constexpr double kLampWidth = 0.15;           // [m]
const Pose2 kBesideAJoint{0.1, -0.117, 0.0};  // 18 mm beside its right side

TEST(BalanceBloom, TakesAJointBesideOneSideForWhatItIs) {
  LevelledLamp lamp({.joint_depth = 30.0, .bloom = kSaturatedBloom}, kBesideAJoint, kLampWidth);
  EXPECT_GT(std::abs(lamp.error().y), 1.0e-3);
  lamp.balance();
  EXPECT_NEAR(lamp.error().x, 0.0, 0.9e-3);  // 4.5 mm per pixel
  EXPECT_NEAR(lamp.error().y, 0.0, 0.9e-3);
  EXPECT_NEAR(lamp.error().theta, 0.0, radians(0.05));
}

TEST(BalanceBloom, MovesAnOutlineFarWhereAJointLiesInBroadBloom) {
  const Pose2 truth{-0.163, -0.45, 0.0};  // its far end 33 mm beside the middle of a joint
  LevelledLamp lamp({.joint_depth = 50.0, .bloom = kSaturatedBloom, .bloom_reach = 0.06}, truth, kLampWidth);
  EXPECT_LT(lamp.error().x, -7.0e-3);
  lamp.balance();
  EXPECT_NEAR(lamp.error().x, 0.0, 1.5e-3);
}

TEST(BalanceBloom, KeepsToTheLevelWhereTheCeilingBeyondOneEndIsFarBrighter) {
  for (const double slope : {-140.0, 140.0}) {  // [grey/m] along it
    LevelledLamp lamp({.grey = 130.0, .slope_x = slope}, {0.1, -0.1, 0.0}, 0.3);
    lamp.balance();
    EXPECT_NEAR(lamp.error().x, 0.0, 1.2e-3) << "3 mm by the balance alone";
    EXPECT_GT(std::sqrt(lamp.fit.covariance(0, 0)), 1.0e-3);
  }
}

TEST(BalanceBloom, SaysThatItIsUnsureOfEndsThatAreTooUnlikeToBalance) {
  LevelledLamp lamp({.bloom = kSaturatedBloom}, {0.05, -0.1, 0.2}, 0.3);
  lamp.balance();
  EXPECT_LT(std::sqrt(lamp.fit.covariance(0, 0)), 0.5e-3);
  lamp.clutter_far_end();
  lamp.balance();
  EXPECT_GT(std::sqrt(lamp.fit.covariance(0, 0)), 1.5e-3);
  EXPECT_NEAR(lamp.error().x, 0.0, 4.0e-3);
  EXPECT_NEAR(lamp.error().y, 0.0, 0.9e-3);
}

TEST(BalanceBloom, PlacesTheOnlyEndInViewByTheBloomOfASideWithoutAJoint) {
  const Pose2 truth{0.475, -0.117, 0.0};  // the border hides its far end's bloom
  LevelledLamp lamp({.joint_depth = 35.0, .bloom = kSaturatedBloom}, truth, kLampWidth);
  EXPECT_LT(lamp.error().x, -3.0e-3);
  lamp.balance();
  EXPECT_NEAR(lamp.error().x, 0.0, 1.0e-3);
  EXPECT_NEAR(lamp.error().y, 0.0, 1.0e-3);
}

TEST(OppositeSides, TakeOffAJointBesideOneOfThemAsItShowsBeyondTheCorners) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const Pose2 truth{0.1, -0.117, 0.0};  // a joint 18 mm beside its right side
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = truth, .width = 0.15}};
  ceiling.joint_depth = 40.0;
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  const Outline outline{.length = 1.2, .width = 0.15, .height = kHeight};
  const double step = 0.0045;  // [m]
  const GreyView view = image.view();
  const OppositeSides sides(view, model, outline, 0.0, {1.0, 0.0}, {0.0, 1.0}, 1.2, 0.075);
  const auto largest = [&](const Differences& differences) {
    double most = 0.0;
    for (std::size_t k = Differences::kInside + 2; k < Differences::kDistances; ++k) {  // beyond the edge itself
      double sum = 0.0;
      for (const auto& stretch : differences.value) {
        sum += static_cast<double>(stretch[k]);
      }
      most = std::max(most, std::abs(sum) / Differences::kStretches);
    }
    return most;
  };
  Differences differences = sides.measure(truth, step, Saturated::kLeftOut);
  EXPECT_GT(largest(differences), 20.0);  // [grey]
  ASSERT_TRUE(sides.take_ceiling_off(truth, step, 0.05, differences));
  EXPECT_LT(largest(differences), 3.0);
}

TEST(OppositeSides, DifferByWhatTheirCeilingsDoUpToWhereTheyAreCutOff) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const Pose2 truth{0.1, -0.1, 0.3};
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = truth}};
  ceiling.slope_x = 40.0 * std::cos(truth.theta);  // [grey/m] along the lamp
  ceiling.slope_y = 40.0 * std::sin(truth.theta);
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  const Outline outline{.length = 1.2, .width = 0.3, .height = kHeight};
  const double step = 0.0045;  // [m]
  const double swelling = 0.005;
  const GreyView view = image.view();
  const OppositeSides ends(view, model, outline, 0.0, {0.0, 1.0}, {1.0, 0.0}, 0.3, 0.6 + swelling);
  const auto mean = [](const Differences& differences, std::size_t k) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t s = 0; s < Differences::kStretches; ++s) {
      sum += differences.valid[s][k] ? static_cast<double>(differences.value[s][k]) : 0.0;
      count += differences.valid[s][k] ? 1 : 0;
    }
    return count > 0 ? sum / count : std::nan("");
  };
  const double of_ceiling = 40.0 * 1.2;  // [grey]
  const auto farthest_off = [&](Saturated saturated) {
    const Differences differences = ends.measure(truth, step, saturated);
    double most = 0.0;
    for (std::size_t k = 0; k < Differences::kInside + 3; ++k) {
      const double off = std::abs(mean(differences, k) - of_ceiling);
      most = std::isnan(off) ? most : std::max(most, off);
    }
    return most;
  };
  // The brighter end alone is saturated on the lamp's steep edge: what is left of it there looks too dark.
  EXPECT_GT(farthest_off(Saturated::kLeftOut), 12.0);
  EXPECT_LT(farthest_off(Saturated::kCutOff), 8.0);
}

TEST(BalanceBloom, LeavesAnOutlineInPlaceWhereTheLightIsEven) {
  LevelledLamp lamp({.bloom = kSaturatedBloom}, kBesideAJoint, kLampWidth);
  lamp.balance();
  EXPECT_NEAR(lamp.error().x, 0.0, 0.9e-3);
  EXPECT_NEAR(lamp.error().y, 0.0, 0.9e-3);
}

}  // namespace
}  // namespace luminav
