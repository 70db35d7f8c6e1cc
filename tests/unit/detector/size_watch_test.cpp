#include "services/detector/size_watch.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/detector/drawn_detections.hpp"

namespace luminav {
namespace {

std::vector<Detection> frame_with(double scale) {
  std::vector<Detection> frame(2);
  frame[0].scale = scale;
  frame[1].clipped = true;
  return frame;
}

std::string complaint_about(double scale, int frames, double other_scale) {
  SizeWatch watch;
  for (int i = 0; i < frames; ++i) {
    watch.add(frame_with(i % 2 == 0 ? scale : other_scale));
  }
  return watch.complaint();
}

TEST(SizeWatch, SaysThatLampsKeepLookingLonger) {
  EXPECT_EQ(complaint_about(1.09, 100, 1.09), "lamps look 9 % longer than the file says: is the ceiling height right?");
  EXPECT_EQ(complaint_about(0.92, 100, 0.92),
            "lamps look 8 % shorter than the file says: is the ceiling height right?");
}

TEST(SizeWatch, SaysNothingOfFewLampsRightSizesOrSizesThatDoNotAgree) {
  EXPECT_EQ(complaint_about(1.09, 20, 1.09), "");
  EXPECT_EQ(complaint_about(1.02, 100, 1.02), "");
  EXPECT_EQ(complaint_about(1.14, 100, 1.00), "");
}

TEST(SizeWatch, HearsOfTheSizeFromTheDetector) {
  for (const DetectionState state : {DetectionState::kLit, DetectionState::kUnlit}) {
    for (const double factor : {0.91, 1.0, 1.09}) {
      test::DrawnCeiling ceiling;
      ceiling.shapes = {{.pose = {0.1, 0.05, 0.4}, .length = 1.2 * factor, .width = 0.3 * factor, .state = state}};
      const auto detections = test::detect(ceiling);
      ASSERT_EQ(detections.size(), 1U) << factor;
      ASSERT_TRUE(detections[0].scale.has_value());
      EXPECT_NEAR(*detections[0].scale, factor, 0.015);
    }
  }
}

}  // namespace
}  // namespace luminav
