#include "services/localizer/hypotheses/hypothesis.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

ObjectTrack seen_in(int frames) {
  ObjectTrack object;
  object.frames = frames;
  return object;
}

TEST(NullHypothesis, HasTheScoreOfAPoseThatExplainsNothing) {
  const HypothesisParams params;
  NullHypothesis null;
  EXPECT_EQ(null.score(), 0.0);
  null.see(std::vector{seen_in(params.frames_for_full_vote), seen_in(100)}, {}, params);
  EXPECT_DOUBLE_EQ(null.score(), 2.0 * params.misfit);
  null.see(std::vector{seen_in(params.frames_for_full_vote / 2)}, {}, params);
  EXPECT_DOUBLE_EQ(null.score(), 0.5 * params.misfit) << "an image shows all that is there";
}

TEST(NullHypothesis, KeepsTheScoreOfWhatIsOver) {
  const HypothesisParams params;
  NullHypothesis null;
  null.see(std::vector{seen_in(100)}, std::vector{seen_in(100)}, params);
  EXPECT_DOUBLE_EQ(null.closed_score(), params.misfit);
  null.settle();
  EXPECT_DOUBLE_EQ(null.closed_score(), 2.0 * params.misfit);
  EXPECT_DOUBLE_EQ(null.score(), 2.0 * params.misfit);
  null.see({}, {}, params);
  EXPECT_DOUBLE_EQ(null.score(), 2.0 * params.misfit);
}

}  // namespace
}  // namespace luminav
