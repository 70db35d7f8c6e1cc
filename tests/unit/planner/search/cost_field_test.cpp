#include "services/planner/search/cost_field.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <random>

namespace luminav {
namespace {

struct Plan {
  int columns;
  std::vector<std::uint8_t> prices;
  std::size_t at(int column, int row) const { return static_cast<std::size_t>(row * columns + column); }
  BitGrid passable() const {
    BitGrid bits(columns, static_cast<int>(prices.size()) / columns);
    for (std::size_t i = 0; i < prices.size(); ++i) {
      if (prices[i] != 0) {
        bits.set({static_cast<int>(i) % columns, static_cast<int>(i) / columns});
      }
    }
    return bits;
  }
};

/// Every price a class of its own.
struct Terrain {
  explicit Terrain(const Plan& plan) : passable(plan.passable()), classes(plan.prices) {
    std::iota(price.begin(), price.end(), std::uint8_t{0});
  }
  CostTerrain get() const { return {&passable, classes.data(), price.data()}; }
  BitGrid passable;
  std::vector<std::uint8_t> classes;
  std::array<std::uint8_t, 256> price{};
};

std::vector<std::uint32_t> costs_of(const CostField& field) {
  std::vector<std::uint32_t> costs;
  for (std::size_t i = 0; i < field.stored.size(); ++i) {
    costs.push_back(field.cost(i));
  }
  return costs;
}

CostField field_from(const Plan& plan, const std::vector<CostSeed>& seeds) {
  CostField field;
  grow_cost_field(Terrain(plan).get(), seeds, {}, field);
  return field;
}

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

TEST(PaperWavefront, LabelsAsThePaperDoes) {
  const Plan plan = plan_of({"######", "#1111#", "#1##1#", "#1111#", "######"});
  const auto labels = wavefront_labels(plan.passable(), plan.at(1, 1), plan.at(4, 3));
  EXPECT_EQ(labels[plan.at(4, 3)], 2U);  // the goal
  EXPECT_EQ(labels[plan.at(3, 3)], 3U);
  EXPECT_EQ(labels[plan.at(4, 2)], 3U);
  EXPECT_EQ(labels[plan.at(3, 1)], 4U);  // diagonal from (4, 2)
  EXPECT_EQ(labels[plan.at(2, 1)], 5U);
  EXPECT_EQ(labels[plan.at(2, 2)], 1U);  // occupied
  EXPECT_EQ(labels[plan.at(1, 1)], 6U);  // the start: reached and left there
}

TEST(PaperWavefront, FollowsLabelsFromStartToGoal) {
  const Plan plan = plan_of({"######", "#1111#", "#1##1#", "#1111#", "######"});
  const auto labels = wavefront_labels(plan.passable(), plan.at(1, 1), plan.at(4, 3));
  const auto cells = follow_labels(labels, plan.columns, plan.at(1, 1));
  ASSERT_EQ(cells.size(), 5U);
  EXPECT_EQ(cells.front(), plan.at(1, 1));
  EXPECT_EQ(cells.back(), plan.at(4, 3));
}

TEST(PaperWavefront, LeavesAClosedRoomWithoutLabels) {
  const Plan plan = plan_of({"#######", "#11#11#", "#11#11#", "#######"});
  const auto labels = wavefront_labels(plan.passable(), plan.at(1, 1), plan.at(4, 1));
  EXPECT_EQ(labels[plan.at(1, 1)], 0U);
  EXPECT_TRUE(follow_labels(labels, plan.columns, plan.at(1, 1)).empty());
}

TEST(CostField, CountsFiveStraightAndSevenDiagonal) {
  const Plan plan = plan_of({"#####", "#111#", "#111#", "#111#", "#####"});
  CostField field = field_from(plan, {{{1, 1}, 0}});
  EXPECT_EQ(field.cost(plan.at(3, 1)), 10U);
  EXPECT_EQ(field.cost(plan.at(3, 3)), 14U);
  EXPECT_EQ(field.cost(plan.at(2, 3)), 12U);
  EXPECT_EQ(field.cost(plan.at(0, 0)), CostField::kUnreached);
}

TEST(CostField, IsTheShortestWayOnRandomPrices) {
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
  CostField field = field_from(plan, {{{3, 3}, 700}});
  // Bellman and Ford, slow and plain
  std::vector<std::uint32_t> cost(plan.prices.size(), CostField::kUnreached);
  cost[plan.at(3, 3)] = 700;
  for (bool changed = true; changed;) {
    changed = false;
    for (int row = 1; row + 1 < kSide; ++row) {
      for (int column = 1; column + 1 < kSide; ++column) {
        const std::size_t here = plan.at(column, row);
        for (int dr = -1; dr <= 1; ++dr) {
          for (int dc = -1; dc <= 1; ++dc) {
            const std::size_t from = plan.at(column + dc, row + dr);
            if ((dr == 0 && dc == 0) || plan.prices[here] == 0 || cost[from] == CostField::kUnreached) {
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
  EXPECT_EQ(costs_of(field), cost);
}

TEST(CostField, StartsFromSeveralSeedsAtTheirCosts) {
  const Plan plan = plan_of({"############", "#1111111111#", "############"});
  CostField field = field_from(plan, {{{1, 1}, 2000}, {{10, 1}, 1990}, {{5, 1}, 5000}});
  EXPECT_EQ(field.cost(plan.at(1, 1)), 2000U);
  EXPECT_EQ(field.cost(plan.at(10, 1)), 1990U);
  EXPECT_EQ(field.cost(plan.at(5, 1)),
            2015U + 0U);  // 10 -> 5 is 25, 1 -> 5 is 20 more than 2000: the nearer one by cost
}

// Where all cells cost the same the wave goes by other rules; the costs must be those of the general one.
TEST(CostField, LeavesOutBlockedSeeds) {
  const Plan plan = plan_of({"####", "#1##", "####"});
  CostField field = field_from(plan, {{{2, 1}, 0}});
  EXPECT_EQ(field.cost(plan.at(1, 1)), CostField::kUnreached);
  field = field_from(plan, {});
  EXPECT_EQ(field.cost(plan.at(1, 1)), CostField::kUnreached);
}

TEST(FollowGradient, EndsAtTheSeedAndCostsWhatTheFieldSays) {
  const Plan plan = plan_of({"########", "#111111#", "#1####1#", "#111111#", "########"});
  CostField field = field_from(plan, {{{6, 3}, 0}});
  const auto cells = follow_gradient(Terrain(plan).get(), field, plan.at(1, 1));
  ASSERT_FALSE(cells.empty());
  EXPECT_EQ(cells.back(), plan.at(6, 3));
  EXPECT_TRUE(follow_gradient(Terrain(plan).get(), field, plan.at(0, 0)).empty());
}

Plan random_plan(std::mt19937& rng, int side) {
  std::uniform_int_distribution<int> price(-12, 36);
  Plan plan{side, std::vector<std::uint8_t>(static_cast<std::size_t>(side * side), 0)};
  for (int row = 1; row + 1 < side; ++row) {
    for (int column = 1; column + 1 < side; ++column) {
      plan.prices[plan.at(column, row)] = static_cast<std::uint8_t>(std::max(0, price(rng)));
    }
  }
  return plan;
}

/// Gives a square of cells new prices, free, blocked or mixed.
std::vector<PriceChange> change(std::mt19937& rng, Plan& plan, std::size_t keep_a, std::size_t keep_b) {
  const int side = plan.columns;
  std::uniform_int_distribution<int> place(1, side - 7);
  std::uniform_int_distribution<int> kind(0, 2);
  std::uniform_int_distribution<int> price(1, 36);
  const int left = place(rng);
  const int low = place(rng);
  const int what = kind(rng);
  std::vector<PriceChange> changes;
  for (int row = low; row < low + 6; ++row) {
    for (int column = left; column < left + 6; ++column) {
      const std::size_t cell = plan.at(column, row);
      const int value = what == 0 ? 0 : what == 1 ? 4 : price(rng) % 37;
      if (cell != keep_a && cell != keep_b) {
        changes.push_back({static_cast<std::uint32_t>(cell), plan.prices[cell]});
        plan.prices[cell] = static_cast<std::uint8_t>(value);
      }
    }
  }
  return changes;
}

TEST(CostFieldRepair, GivesTheFieldOfANewWave) {
  std::mt19937 rng(11);
  constexpr int kSide = 40;
  for (int world = 0; world < 20; ++world) {
    Plan plan = random_plan(rng, kSide);
    const std::size_t goal = plan.at(20, 20);
    const std::size_t start = plan.at(5, 30);
    plan.prices[goal] = plan.prices[start] = 9;
    CostField field = field_from(plan, {{{20, 20}, 0}});
    for (int round = 0; round < 10; ++round) {
      const std::vector<PriceChange> changes = change(rng, plan, goal, start);
      const Terrain terrain(plan);
      // a margin that nothing exceeds: every cell must come out right
      ASSERT_TRUE(repair_cost_field(terrain.get(), changes, {static_cast<std::int64_t>(start), 1'000'000'000}, field));
      ASSERT_EQ(costs_of(field), costs_of(field_from(plan, {{{20, 20}, 0}})))
          << "world " << world << " round " << round;
    }
  }
}

TEST(CostFieldRepair, IsRightUpToTheMarginOrSaysThatItIsNot) {
  std::mt19937 rng(12);
  constexpr int kSide = 60;
  int repaired = 0;
  for (int world = 0; world < 20; ++world) {
    Plan plan = random_plan(rng, kSide);
    const std::size_t goal = plan.at(30, 30);
    plan.prices[goal] = 9;
    for (const std::size_t start : {plan.at(10, 40), plan.at(25, 35)}) {
      plan.prices[start] = 9;
      const CostStop stop{static_cast<std::int64_t>(start), 300};
      CostField field;
      grow_cost_field(Terrain(plan).get(), {{{30, 30}, 0}}, stop, field);
      for (int round = 0; round < 10; ++round) {
        const std::vector<PriceChange> changes = change(rng, plan, goal, start);
        const Terrain terrain(plan);
        const CostField fresh = field_from(plan, {{{30, 30}, 0}});
        if (!repair_cost_field(terrain.get(), changes, stop, field)) {
          grow_cost_field(terrain.get(), {{{30, 30}, 0}}, stop, field);
          continue;
        }
        ++repaired;
        ASSERT_EQ(field.cost(start), fresh.cost(start));
        for (std::size_t i = 0; i < field.stored.size(); ++i) {
          ASSERT_TRUE(!field.is_reached(i) || field.cost(i) == fresh.cost(i));
        }
      }
    }
  }
  EXPECT_GT(repaired, 200);
}

}  // namespace
}  // namespace luminav
