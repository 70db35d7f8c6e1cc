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
  const auto score = [&](const std::vector<ObjectTrack>& scene) { return score_of_misfits(scene, false, params); };
  EXPECT_EQ(score({}), 0.0);
  EXPECT_DOUBLE_EQ(score({seen_in(params.frames_for_full_vote), seen_in(100)}), 2.0 * params.misfit);
  EXPECT_DOUBLE_EQ(score({seen_in(params.frames_for_full_vote / 2)}), 0.5 * params.misfit);
}

TEST(Hypothesis, ThatExplainsNothingHasTheScoreOfTheMisfits) {
  const HypothesisParams params;
  Hypothesis hypothesis;
  ObjectTrack object = seen_in(3);
  add_evidence(hypothesis, object, -1, params.misfit, 1.0, object.frames);
  EXPECT_DOUBLE_EQ(score_of(hypothesis, 0.0, params), score_of_misfits(std::vector{object}, false, params));
  settle_all(hypothesis, params);
  EXPECT_DOUBLE_EQ(hypothesis.closed_score, score_of_misfits(std::vector{object}, false, params));
}

TEST(Hypothesis, PaysLessForWhatNeedNotBeListedAndLeastForALampOfARow) {
  const HypothesisParams params;
  ObjectTrack object = seen_in(params.frames_for_full_vote);
  const auto score = [&](bool may_be_unlisted) {
    return score_of_misfits(std::vector{object, object}, may_be_unlisted, params);
  };
  const double unlisted = score(true);
  EXPECT_DOUBLE_EQ(unlisted, 2.0 * log_likelihood_unlisted(object));
  EXPECT_GT(unlisted, score(false) + 4.0);
  object.extends_row = true;
  EXPECT_GT(score(true), unlisted + 2.0);
  EXPECT_DOUBLE_EQ(score(false), 2.0 * params.misfit) << "where all are listed no row excuses it";
}

}  // namespace
}  // namespace luminav
