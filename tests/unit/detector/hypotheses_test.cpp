#include <gtest/gtest.h>

#include <vector>

#include "services/detector/hypotheses/cell_plane.hpp"
#include "services/detector/hypotheses/outline_proposer.hpp"
#include "services/detector/hypotheses/region_limits.hpp"
#include "services/detector/hypotheses/region_shape.hpp"
#include "services/detector/hypotheses/tried_hypotheses.hpp"
#include "services/detector/sampling/raster.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

constexpr int kFactor = 4;
constexpr double kHeight = 2.8;

CeilingCamera straight_up() {
  CameraDescription camera;
  camera.mounting.z = 0.3;  // a cell is 18 mm on the ceiling
  return CeilingCamera(camera.intrinsics, camera.mounting);
}

/// Cells columns x rows from a corner on, as a region.
class DrawnRegion {
 public:
  DrawnRegion(int left, int top, int columns, int rows) {
    Raster mask(120, 160, std::uint8_t{0});
    mask(cv::Rect(left, top, columns, rows)) = 255;
    regions_ = finder_.find(mask, 1);
  }
  [[nodiscard]] const Region& region() const { return regions_.front(); }

 private:
  RegionFinder finder_;
  std::vector<Region> regions_;
};

class Proposals : public testing::Test {
 protected:
  const std::vector<OutlineHypothesis>& of(const DrawnRegion& drawn, bool bright = true, double bloom = 0.05) {
    EXPECT_TRUE(shape_.take(drawn.region(), 0, plane_));
    return proposer_.propose(shape_, bright, {.bloom = bright ? bloom : 0.0});
  }

  CeilingCamera camera_ = straight_up();
  CellPlane plane_{camera_, kFactor, kHeight};
  CeilingCatalogue catalogue_{
      .fixtures = {{.length = 1.2, .width = 0.3, .lamps = 1}}, .elements = {}, .ceiling_height = kHeight};
  RegionShape shape_;
  OutlineProposer proposer_{plane_, catalogue_};
};

TEST(CellPlane, KnowsWhereCellsLieAndHowLargeTheyAre) {
  const CellPlane plane(straight_up(), kFactor, kHeight);
  EXPECT_NEAR(plane.footprint(80, 60).side, 0.01805, 1e-4);
  EXPECT_NEAR(plane.footprint(80, 60).area, 0.01805 * 0.01805, 1e-6);
  EXPECT_TRUE(plane.is_at_border(0, 60));
  EXPECT_FALSE(plane.is_at_border(1, 60));
}

TEST_F(Proposals, GuessAWholeFixtureOfARegionOfItsSize) {
  const auto& guesses = of(DrawnRegion(40, 50, 67, 17));  // 1.21 x 0.31 m
  ASSERT_EQ(guesses.size(), 1U);
  EXPECT_TRUE(guesses[0].is_whole);
  EXPECT_LT(guesses[0].size_error, 0.02);
  EXPECT_NEAR(guesses[0].fill, 1.0, 0.02);
}

TEST_F(Proposals, AllowATenthOfTheSizeButNotAThird) {
  EXPECT_FALSE(of(DrawnRegion(40, 50, 60, 15)).empty());
  EXPECT_FALSE(of(DrawnRegion(40, 50, 73, 18)).empty());
  EXPECT_TRUE(of(DrawnRegion(40, 50, 44, 17)).empty());
}

TEST_F(Proposals, TakeBloomThatWidensAllSidesAlikeForNoSizeError) {
  const auto& guesses = of(DrawnRegion(40, 45, 72, 22));  // 50 mm on each side
  ASSERT_FALSE(guesses.empty());
  EXPECT_LT(guesses[0].size_error, 0.02);
  EXPECT_NEAR(guesses[0].start.side_outset, 0.05, 0.01);
}

TEST_F(Proposals, TryACutRegionFromTheEndInView) {
  const auto& guesses = of(DrawnRegion(0, 50, 40, 17));  // 0.72 m of it
  ASSERT_FALSE(guesses.empty());
  for (const OutlineHypothesis& guess : guesses) {
    EXPECT_FALSE(guess.is_whole);
  }
}

TEST_F(Proposals, GuessNothingOfARegionThatFillsHalfOfItsRectangle) {
  Raster mask(120, 160, std::uint8_t{0});
  for (int y = 50; y < 67; ++y) {
    std::fill_n(mask[y] + 40, (y - 50) * 4 + 3, std::uint8_t{255});  // a triangle
  }
  RegionFinder finder;
  RegionShape shape;
  ASSERT_TRUE(shape.take(finder.find(mask, 1).front(), 0, plane_));
  EXPECT_TRUE(proposer_.propose(shape, true, {.bloom = 0.05}).empty());
}

TEST_F(Proposals, ForgiveTheRaggedRimOfALampThatIsAFewCellsWide) {
  const CeilingCatalogue narrow{
      .fixtures = {{.length = 1.2, .width = 0.08, .lamps = 1}}, .elements = {}, .ceiling_height = kHeight};
  Raster mask(120, 160, std::uint8_t{0});
  for (int x = 0; x < 67; ++x) {  // 3 cells, and every eighth column one more on either side
    const int more = x % 8 == 4 ? 1 : 0;
    mask(cv::Rect(40 + x, 50 - more, 1, 3 + 2 * more)) = 255;
  }
  RegionFinder finder;
  RegionShape shape;
  OutlineProposer proposer(plane_, narrow);
  ASSERT_TRUE(shape.take(finder.find(mask, 1).front(), 0, plane_));
  const auto& guesses = proposer.propose(shape, true, {.bloom = 0.05});
  ASSERT_FALSE(guesses.empty());
  EXPECT_TRUE(guesses[0].is_whole);
  EXPECT_LT(guesses[0].fill, 0.68);
}

TEST(RegionShape, SaysWhereTheBorderCutsItOff) {
  const CellPlane plane(straight_up(), kFactor, kHeight);
  RegionShape shape;
  ASSERT_TRUE(shape.take(DrawnRegion(0, 50, 40, 17).region(), 0, plane));
  EXPECT_TRUE(shape.touches_border());
  int cut_off = 0;
  for (const auto& orientation : shape.orientations()) {
    cut_off += (shape.is_cut_off(orientation.along) ? 1 : 0) + (shape.is_cut_off(-orientation.along) ? 1 : 0);
  }
  EXPECT_EQ(cut_off, 1);
}

TEST_F(Proposals, ComeFromRegionsNoLargerThanWhatHangsHere) {
  const RegionLimits limits({}, camera_, catalogue_);
  EXPECT_EQ(limits.factor, kFactor) << "a fixture of 0.3 m is 66 pixels wide";
  EXPECT_TRUE(limits.may_be_a_kind(DrawnRegion(40, 50, 66, 17).region(), plane_));
  EXPECT_FALSE(limits.may_be_a_kind(DrawnRegion(10, 50, 130, 17).region(), plane_)) << "twice as long";
  EXPECT_FALSE(limits.may_be_a_kind(DrawnRegion(40, 30, 66, 60).region(), plane_)) << "more than three times as wide";
}

TEST(RegionLimits, LookAtNarrowLampsMoreFinely) {
  const CeilingCatalogue tubes{
      .fixtures = {{.length = 1.2, .width = 0.06, .lamps = 1}}, .elements = {}, .ceiling_height = kHeight};
  EXPECT_EQ(RegionLimits({}, straight_up(), tubes).factor, 2);
}

TEST(TriedHypotheses, AreFittedOnce) {
  OutlineHypothesis hypothesis;
  TriedHypotheses tried;
  tried.begin_frame();
  EXPECT_TRUE(tried.add(hypothesis));
  hypothesis.start.pose = {0.02, 0.0, kPi};
  EXPECT_FALSE(tried.add(hypothesis)) << "a fit takes it to the same place";
  tried.forget_last();
  EXPECT_TRUE(tried.add(hypothesis));
  hypothesis.burning = 1;
  EXPECT_TRUE(tried.add(hypothesis));
}

TEST(TriedHypotheses, AreNoMoreThanAFrameIsWorth) {
  OutlineHypothesis hypothesis;
  TriedHypotheses tried;
  tried.begin_frame();
  for (int i = 0; i < TriedHypotheses::kMaxFits; ++i) {
    hypothesis.start.pose.x = i;
    EXPECT_TRUE(tried.add(hypothesis));
  }
  tried.clear();
  EXPECT_FALSE(tried.add(hypothesis));
  tried.begin_frame();
  EXPECT_TRUE(tried.add(hypothesis));
}

}  // namespace
}  // namespace luminav
