#include "services/localizer/audit/resolving_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace luminav {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

/// Places a metre apart on a line; each rival is refuted at the places named.
RivalGround line(int places, const std::vector<std::vector<int>>& refuted_at) {
  RivalGround ground;
  ground.rival_count = refuted_at.size();
  for (int i = 0; i < places; ++i) {
    ground.points.emplace_back(i, 0.0);
    ground.is_blind.push_back(false);
    ground.neighbours.emplace_back();
    if (i > 0) {
      ground.neighbours.back().push_back(i - 1);
    }
    if (i + 1 < places) {
      ground.neighbours.back().push_back(i + 1);
    }
    ground.rivals.emplace_back();
    for (std::size_t rival = 0; rival < refuted_at.size(); ++rival) {
      float distance = kNever;
      for (const int place : refuted_at[rival]) {
        distance = std::min(distance, static_cast<float>(std::abs(place - i)));
      }
      if (distance > 0.0F) {
        ground.rivals.back().push_back({static_cast<std::int32_t>(rival), distance});
      }
    }
    std::stable_sort(ground.rivals.back().begin(), ground.rivals.back().end(),
                     [](const RivalAtPlace& a, const RivalAtPlace& b) { return a.distance > b.distance; });
  }
  return ground;
}

TEST(ResolvingWalk, GoesOneWayForOneRivalAndBackForAnother) {
  const RivalGround ground = line(10, {{2}, {7}});
  ResolvingWalk walk(ground);
  EXPECT_DOUBLE_EQ(walk.length(4), 2.0 + 5.0);
  EXPECT_DOUBLE_EQ(walk.length(5), 2.0 + 5.0);
  EXPECT_DOUBLE_EQ(walk.length(0), 7.0);
  EXPECT_DOUBLE_EQ(walk.length(9), 7.0);
}

TEST(ResolvingWalk, NeedsNoWayWithoutRivalsAndFindsNoneWhereOneIsRefutedNowhere) {
  const RivalGround none = line(5, {});
  EXPECT_DOUBLE_EQ(ResolvingWalk(none).length(2), 0.0);
  const RivalGround never = line(5, {{0}, {}});
  EXPECT_TRUE(std::isinf(ResolvingWalk(never).length(2)));
}

TEST(ResolvingWalk, BlindItDrivesToWhereTheWholeWayIsShortest) {
  // the nearest place in sight is on the left, but the rival there is refuted far off only
  RivalGround ground = line(12, {{11}});
  for (int i = 2; i < 8; ++i) {
    ground.is_blind[static_cast<std::size_t>(i)] = true;
  }
  ground.rivals[8].clear();
  EXPECT_DOUBLE_EQ(ResolvingWalk(ground).length(3), 5.0);
  EXPECT_DOUBLE_EQ(ResolvingWalk(ground).length(8), 0.0);
}

TEST(ResolvingWalk, IsAsShortAsTheShortestOfAllWalks) {
  // on a line a walk is two turning points: all of them are tried
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::vector<int>> refuted_at(70);  // more than fit into one word
    for (std::vector<int>& places : refuted_at) {
      places = {static_cast<int>(random() % 20), static_cast<int>(random() % 20)};
    }
    const int from = static_cast<int>(random() % 20);
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
    const RivalGround ground = line(20, refuted_at);
    ResolvingWalk walk(ground);
    EXPECT_DOUBLE_EQ(walk.length(from), best);
    EXPECT_DOUBLE_EQ(walk.length(from), best) << "asked again";
    EXPECT_LE(ResolvingWalk(ground, 3).length(from), best) << "ended early it is a bound";
  }
}

}  // namespace
}  // namespace luminav
