#include "services/localizer/audit/resolving_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace luminav {
namespace {

/// Places a metre apart on a line.
WalkGround line(int places) {
  WalkGround ground;
  for (int i = 0; i < places; ++i) {
    ground.points.emplace_back(i, 0.0);
    ground.neighbours.emplace_back();
    if (i > 0) {
      ground.neighbours.back().push_back(i - 1);
    }
    if (i + 1 < places) {
      ground.neighbours.back().push_back(i + 1);
    }
  }
  return ground;
}

/// Each rival is refuted at the places named.
using RefutedAt = std::vector<std::vector<int>>;

ResolvingWalk::Result find(ResolvingWalk& walk, int from, const RefutedAt& refuted_at) {
  return walk.find(from, refuted_at.size(), [&](std::size_t rival, std::int32_t place) {
    return std::find(refuted_at[rival].begin(), refuted_at[rival].end(), place) == refuted_at[rival].end();
  });
}

TEST(ResolvingWalk, GoesOneWayForOneRivalAndBackForAnother) {
  const WalkGround ground = line(10);
  ResolvingWalk walk(ground);
  const RefutedAt refuted_at{{2}, {7}};
  EXPECT_DOUBLE_EQ(find(walk, 4, refuted_at).length, 2.0 + 5.0);
  EXPECT_DOUBLE_EQ(find(walk, 5, refuted_at).length, 2.0 + 5.0);
  EXPECT_DOUBLE_EQ(find(walk, 0, refuted_at).length, 7.0);
  EXPECT_DOUBLE_EQ(find(walk, 9, refuted_at).length, 7.0);
  EXPECT_EQ(find(walk, 4, refuted_at).deciding.size(), 2U);
}

TEST(ResolvingWalk, NeedsNoWayWithoutRivalsAndFindsNoneWhereOneIsRefutedNowhere) {
  const WalkGround ground = line(5);
  ResolvingWalk walk(ground);
  EXPECT_DOUBLE_EQ(find(walk, 2, {}).length, 0.0);
  EXPECT_TRUE(std::isinf(find(walk, 2, {{0}, {}}).length));
}

TEST(ResolvingWalk, ARivalThatIsRefutedSoonerAsksForNoMore) {
  const WalkGround ground = line(10);
  ResolvingWalk walk(ground);
  EXPECT_DOUBLE_EQ(find(walk, 0, {{3}, {2}, {9}, {5}}).length, 9.0);
}

TEST(ResolvingWalk, IsAsShortAsTheShortestOfAllWalks) {
  // on a line a walk is two turning points: all of them are tried
  const WalkGround ground = line(20);
  ResolvingWalk walk(ground);
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    RefutedAt refuted_at(70);  // more than can decide
    const int from = static_cast<int>(random() % 20);
    for (std::vector<int>& places : refuted_at) {
      for (int i = 0; i < 2; ++i) {
        places.push_back((from + 1 + static_cast<int>(random() % 19)) % 20);
      }
    }
    double best = 1e9;
    for (int left = 0; left <= from; ++left) {
      for (int right = from; right < 20; ++right) {
        const bool resolves = std::all_of(refuted_at.begin(), refuted_at.end(), [&](const std::vector<int>& places) {
          return std::any_of(places.begin(), places.end(), [&](int at) { return left <= at && at <= right; });
        });
        const int shorter = std::min(from - left, right - from);
        best = resolves ? std::min(best, static_cast<double>(right - left + shorter)) : best;
      }
    }
    EXPECT_DOUBLE_EQ(find(walk, from, refuted_at).length, best);
    EXPECT_DOUBLE_EQ(find(walk, from, refuted_at).length, best) << "asked again";
    ResolvingWalk hasty(ground, 3);
    EXPECT_LE(find(hasty, from, refuted_at).length, best) << "ended early it is a bound";
  }
}

}  // namespace
}  // namespace luminav
