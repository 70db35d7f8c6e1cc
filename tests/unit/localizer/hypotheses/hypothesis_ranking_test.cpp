#include "services/localizer/hypotheses/hypothesis_ranking.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace luminav {
namespace {

constexpr int kUnbounded = 1000000;  // [units]

Hypothesis hypothesis(int id, const Pose2& pose, double score) {
  Hypothesis result;
  result.id = id;
  result.belief.pose = pose;
  result.closed_score = score;
  return result;
}

std::vector<int> ids(const std::vector<Hypothesis>& hypotheses) {
  std::vector<int> result;
  for (const Hypothesis& h : hypotheses) {
    result.push_back(h.id);
  }
  return result;
}

class Ranking : public ::testing::Test {
 protected:
  void rank(double best_sonar = 0.0) {
    WorkBudget budget(kUnbounded);
    ranking_.begin();
    ASSERT_TRUE(ranking_.advance(list_, best_sonar, budget));
  }

  HypothesisParams params_;
  HypothesisRanking ranking_{params_};
  std::vector<Hypothesis> list_;
};

TEST_F(Ranking, SortsByScoreAndEqualOnesAsTheyCame) {
  list_ = {hypothesis(1, {0.0, 0.0, 0.0}, -5.0), hypothesis(2, {2.0, 0.0, 0.0}, -1.0),
           hypothesis(3, {4.0, 0.0, 0.0}, -5.0), hypothesis(4, {6.0, 0.0, 0.0}, -2.0)};
  rank();
  EXPECT_EQ(ids(list_), (std::vector{2, 4, 1, 3}));
  EXPECT_EQ(list_.front().log_posterior, -1.0);
  EXPECT_EQ(list_.back().log_posterior, -5.0);
}

TEST_F(Ranking, OfNothingIsNothing) {
  rank();
  EXPECT_TRUE(list_.empty());
}

TEST_F(Ranking, KeepsTheBetterOfTwoThatCameTogether) {
  list_ = {hypothesis(1, {3.95, 1.0, kPi - 0.05}, -2.0), hypothesis(2, {4.05, 1.0, 0.05 - kPi}, -1.0)};
  rank();
  EXPECT_EQ(ids(list_), std::vector{2});
}

TEST_F(Ranking, KeepsPosesApartThatLieOrLookApart) {
  const double apart = 1.1 * params_.merge_distance;
  const double turned = 1.1 * params_.merge_angle;
  list_ = {hypothesis(1, {4.0, 1.0, 0.0}, -1.0), hypothesis(2, {4.0 + apart, 1.0, 0.0}, -2.0),
           hypothesis(3, {4.0, 1.0, turned}, -3.0), hypothesis(4, {4.0, 1.0, kPi}, -4.0)};
  rank();
  EXPECT_EQ(ids(list_), (std::vector{1, 2, 3, 4}));
}

TEST_F(Ranking, GivesUpWhatIsFarBehindTheBest) {
  list_ = {hypothesis(1, {0.0, 0.0, 0.0}, -1.0), hypothesis(2, {2.0, 0.0, 0.0}, -0.9 - params_.prune),
           hypothesis(3, {4.0, 0.0, 0.0}, -1.1 - params_.prune)};
  rank();
  EXPECT_EQ(ids(list_), (std::vector{1, 2}));
}

TEST_F(Ranking, GivesUpWhatDroveThroughAWallOrIsNoNumber) {
  list_ = {hypothesis(1, {0.0, 0.0, 0.0}, -1.0), hypothesis(2, {2.0, 0.0, 0.0}, 0.0),
           hypothesis(3, {4.0, 0.0, 0.0}, -1.0)};
  list_[1].walls = -15.5;
  list_[1].log_prior = 15.0;
  list_[2].belief.covariance(0, 0) = std::numeric_limits<double>::infinity();
  rank();
  EXPECT_EQ(ids(list_), std::vector{1});
}

TEST_F(Ranking, KeepsNoMoreThanTheMostAllowed) {
  params_.max = 2;
  list_ = {hypothesis(1, {0.0, 0.0, 0.0}, -3.0), hypothesis(2, {2.0, 0.0, 0.0}, -2.0),
           hypothesis(3, {4.0, 0.0, 0.0}, -1.0)};
  rank();
  EXPECT_EQ(ids(list_), (std::vector{3, 2}));
}

TEST_F(Ranking, CountsSonarBehindTheBestAndNoMoreThanItsCap) {
  list_ = {hypothesis(1, {0.0, 0.0, 0.0}, 0.0), hypothesis(2, {2.0, 0.0, 0.0}, -1.0),
           hypothesis(3, {4.0, 0.0, 0.0}, -2.0)};
  list_[0].sonar = -100.0;
  list_[1].sonar = 1.0;
  list_[2].sonar = 9.0;
  rank(4.0);
  EXPECT_EQ(ids(list_), (std::vector{3, 2, 1}));
  EXPECT_EQ(list_[0].sonar_part, 0.0);
  EXPECT_EQ(list_[1].sonar_part, -3.0);
  EXPECT_EQ(list_[1].log_posterior, -4.0);
  EXPECT_EQ(list_[2].sonar_part, -params_.sonar_cap);
}

TEST_F(Ranking, InSmallStepsEndsAsAtOnceAndChangesNothingBefore) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> place(0.0, 12.0);
  std::uniform_real_distribution<double> score(-25.0, 0.0);
  for (int id = 1; id <= 300; ++id) {
    list_.push_back(hypothesis(id, {place(generator), place(generator), 0.0}, score(generator)));
  }
  std::vector<Hypothesis> in_steps = list_;
  const std::vector<int> before = ids(in_steps);
  rank();
  ASSERT_LT(list_.size(), in_steps.size());

  WorkBudget budget(40);
  ranking_.begin();
  int steps = 1;
  while (!ranking_.advance(in_steps, 0.0, budget)) {
    ASSERT_EQ(ids(in_steps), before);
    ASSERT_LT(++steps, 1000);
    budget.renew();
  }
  EXPECT_GT(steps, 10);
  EXPECT_EQ(ids(in_steps), ids(list_));
}

}  // namespace
}  // namespace luminav
