#include "services/planner/wavefront.hpp"

#include <gtest/gtest.h>

#include <queue>
#include <random>

namespace luminav {
namespace {

struct Plan {
  int columns;
  std::vector<std::uint8_t> prices;
  std::size_t at(int column, int row) const { return static_cast<std::size_t>(row * columns + column); }
};

/// The top line is row 0 here; # blocked, a digit its price.
Plan plan_of(const std::vector<std::string>& lines) {
  Plan plan{static_cast<int>(lines.front().size()), {}};
  for (const std::string& line : lines) {
    for (const char letter : line) {
      plan.prices.push_back(letter == '#' ? 0 : static_cast<std::uint8_t>(letter - '0'));
    }
  }
  return plan;
}

TEST(Wavefront, LabelsAsThePaperDoes) {
  const Plan plan = plan_of({"######", "#1111#", "#1##1#", "#1111#", "######"});
  const auto labels = wavefront_labels(plan.prices, plan.columns, plan.at(1, 1), plan.at(4, 3));
  EXPECT_EQ(labels[plan.at(4, 3)], 2U);  // the goal
  EXPECT_EQ(labels[plan.at(3, 3)], 3U);
  EXPECT_EQ(labels[plan.at(4, 2)], 3U);
  EXPECT_EQ(labels[plan.at(3, 1)], 4U);  // diagonal from (4, 2)
  EXPECT_EQ(labels[plan.at(2, 1)], 5U);
  EXPECT_EQ(labels[plan.at(2, 2)], 1U);  // occupied
  EXPECT_EQ(labels[plan.at(1, 1)], 6U);  // the start: reached and left there
}

TEST(Wavefront, FollowsLabelsFromStartToGoal) {
  const Plan plan = plan_of({"######", "#1111#", "#1##1#", "#1111#", "######"});
  const auto labels = wavefront_labels(plan.prices, plan.columns, plan.at(1, 1), plan.at(4, 3));
  const auto cells = follow_labels(labels, plan.columns, plan.at(1, 1));
  ASSERT_EQ(cells.size(), 5U);
  EXPECT_EQ(cells.front(), plan.at(1, 1));
  EXPECT_EQ(cells.back(), plan.at(4, 3));
}

TEST(Wavefront, LeavesAClosedRoomWithoutLabels) {
  const Plan plan = plan_of({"#######", "#11#11#", "#11#11#", "#######"});
  const auto labels = wavefront_labels(plan.prices, plan.columns, plan.at(1, 1), plan.at(4, 1));
  EXPECT_EQ(labels[plan.at(1, 1)], 0U);
  EXPECT_TRUE(follow_labels(labels, plan.columns, plan.at(1, 1)).empty());
}

TEST(Wave, CountsFiveStraightAndSevenDiagonal) {
  const Plan plan = plan_of({"#####", "#111#", "#111#", "#111#", "#####"});
  WaveField field;
  grow_wave(plan.prices, plan.columns, {{{1, 1}, 0}}, -1, field);
  EXPECT_EQ(field.cost[plan.at(3, 1)], 10U);
  EXPECT_EQ(field.cost[plan.at(3, 3)], 14U);
  EXPECT_EQ(field.cost[plan.at(2, 3)], 12U);
  EXPECT_EQ(field.cost[plan.at(0, 0)], WaveField::kUnreached);
}

TEST(Wave, IsTheShortestWayOnRandomPrices) {
  std::mt19937 rng(4);
  std::uniform_int_distribution<int> price(0, 36);
  constexpr int kSide = 30;
  Plan plan{kSide, std::vector<std::uint8_t>(kSide * kSide, 0)};
  for (int row = 1; row + 1 < kSide; ++row) {
    for (int column = 1; column + 1 < kSide; ++column) {
      plan.prices[plan.at(column, row)] = static_cast<std::uint8_t>(price(rng));
    }
  }
  plan.prices[plan.at(3, 3)] = 9;
  WaveField field;
  grow_wave(plan.prices, kSide, {{{3, 3}, 700}}, -1, field);
  // Bellman and Ford, slow and plain
  std::vector<std::uint32_t> cost(plan.prices.size(), WaveField::kUnreached);
  cost[plan.at(3, 3)] = 700;
  for (bool changed = true; changed;) {
    changed = false;
    for (int row = 1; row + 1 < kSide; ++row) {
      for (int column = 1; column + 1 < kSide; ++column) {
        const std::size_t here = plan.at(column, row);
        for (int dr = -1; dr <= 1; ++dr) {
          for (int dc = -1; dc <= 1; ++dc) {
            const std::size_t from = plan.at(column + dc, row + dr);
            if ((dr == 0 && dc == 0) || plan.prices[here] == 0 || cost[from] == WaveField::kUnreached) {
              continue;
            }
            const std::uint32_t total = cost[from] + plan.prices[from] * (dr != 0 && dc != 0 ? 7U : 5U);
            if (total < cost[here]) {
              cost[here] = total;
              changed = true;
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(field.cost, cost);
}

TEST(Wave, StartsFromSeveralSeedsAtTheirCosts) {
  const Plan plan = plan_of({"############", "#1111111111#", "############"});
  WaveField field;
  grow_wave(plan.prices, plan.columns, {{{1, 1}, 2000}, {{10, 1}, 1990}, {{5, 1}, 5000}}, -1, field);
  EXPECT_EQ(field.cost[plan.at(1, 1)], 2000U);
  EXPECT_EQ(field.cost[plan.at(10, 1)], 1990U);
  EXPECT_EQ(field.cost[plan.at(5, 1)],
            2015U + 0U);  // 10 -> 5 is 25, 1 -> 5 is 20 more than 2000: the nearer one by cost
}

TEST(Wave, LeavesOutBlockedSeeds) {
  const Plan plan = plan_of({"####", "#1##", "####"});
  WaveField field;
  grow_wave(plan.prices, plan.columns, {{{2, 1}, 0}}, -1, field);
  EXPECT_EQ(field.cost[plan.at(1, 1)], WaveField::kUnreached);
  grow_wave(plan.prices, plan.columns, {}, -1, field);
  EXPECT_EQ(field.cost[plan.at(1, 1)], WaveField::kUnreached);
}

TEST(Descend, EndsAtTheSeedAndCostsWhatTheFieldSays) {
  const Plan plan = plan_of({"########", "#111111#", "#1####1#", "#111111#", "########"});
  WaveField field;
  grow_wave(plan.prices, plan.columns, {{{6, 3}, 0}}, -1, field);
  const auto cells = descend(plan.prices, field, plan.at(1, 1));
  ASSERT_FALSE(cells.empty());
  EXPECT_EQ(cells.back(), plan.at(6, 3));
  EXPECT_TRUE(descend(plan.prices, field, plan.at(0, 0)).empty());
}

}  // namespace
}  // namespace luminav
