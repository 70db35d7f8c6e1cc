#include "services/localizer/hypotheses/hypothesis.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

ObjectTrack seen_in(int frames) {
  ObjectTrack object;
  object.frames = frames;
  return object;
}

TEST(Hypothesis, HasAFullMisfitForEachObjectSeenOftenIfItExplainsNothing) {
  const HypothesisParams params;
  const auto score = [&](const std::vector<ObjectTrack>& scene) { return score_of_misfits(scene, params); };
  EXPECT_EQ(score({}), 0.0);
  EXPECT_DOUBLE_EQ(score({seen_in(params.frames_for_full_vote), seen_in(100)}), 2.0 * params.misfit);
  EXPECT_DOUBLE_EQ(score({seen_in(params.frames_for_full_vote / 2)}), 0.5 * params.misfit);
}

TEST(Hypothesis, ThatExplainsNothingHasTheScoreOfTheMisfits) {
  const HypothesisParams params;
  Hypothesis hypothesis;
  ObjectTrack object = seen_in(3);
  add_evidence(hypothesis, object, -1, params.misfit, 1.0, object.frames);
  EXPECT_DOUBLE_EQ(score_of(hypothesis, 0.0, params), score_of_misfits(std::vector{object}, params));
  settle_all(hypothesis, params);
  EXPECT_DOUBLE_EQ(hypothesis.closed_score, score_of_misfits(std::vector{object}, params));
}

}  // namespace
}  // namespace luminav
