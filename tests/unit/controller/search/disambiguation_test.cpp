#include "services/controller/search/disambiguation.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::test_robot;

Fixture fixture_at(double x, double y, double theta = 0.0) {
  Fixture fixture;
  fixture.world_from_fixture = {x, y, theta};
  return fixture;
}

/// A map of free cells of 0.1 m from (-15, -15) to (35, 15), but for walls in some of them.
PriorMap floor_with_walls(const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& walls) {
  PriorMap map;
  map.geometry = {0.1, {-15.0, -15.0}, 500, 300};
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (const auto& [low, high] : walls) {
    for (double x = low.x() + 0.05; x < high.x(); x += 0.1) {
      for (double y = low.y() + 0.05; y < high.y(); y += 0.1) {
        map.cells[map.geometry.index(map.geometry.cell_at({x, y}))] = Prior::kOccupied;
      }
    }
  }
  return map;
}

class DisambiguationTest : public ::testing::Test {
 protected:
  DisambiguationTest() { map_.visit(Eigen::Vector2d::Zero()); }

  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> path(
      const std::vector<Fixture>& fixtures, const PriorMap& walls, const std::vector<PoseAlternative>& alternatives,
      const std::optional<Eigen::Vector2d>& heading_for = std::nullopt) const {
    Building building;
    building.fixtures = fixtures;
    const Disambiguation disambiguation(CeilingForecast(building, walls, 1.2, 0.28));
    return disambiguation.path({Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), heading_for}, alternatives, map_);
  }

  SearchMap map_{test_robot().sonar};
};

// The robot stands below one of two fixtures; only the second has another one 3 m to its left.
const std::vector<Fixture> kTwoAlike{fixture_at(0, 0), fixture_at(20, 0), fixture_at(20, 3)};
const std::vector<PoseAlternative> kBelowEither{{{0, 0, 0}, 0.5}, {{20, 0, 0}, 0.5}};

TEST_F(DisambiguationTest, LeadsToWhereOneSeesAFixtureAndTheOtherDoesNot) {
  const auto found = path(kTwoAlike, floor_with_walls({}), kBelowEither);
  ASSERT_TRUE(found);
  EXPECT_LT((found->back() - Eigen::Vector2d(0, 3)).norm(), 1.0);
  EXPECT_LT(found->front().norm(), 0.3);
}

TEST_F(DisambiguationTest, SaysTheSameInAnyOdometryFrame) {
  // the same two places, told by a robot whose odometry is turned by a quarter: left is behind it now
  const std::vector<PoseAlternative> turned{{{0, 0, kPi / 2}, 0.5}, {{20, 0, kPi / 2}, 0.5}};
  const auto found = path(kTwoAlike, floor_with_walls({}), turned);
  ASSERT_TRUE(found);
  EXPECT_LT((found->back() - Eigen::Vector2d(3, 0)).norm(), 1.0);
}

TEST_F(DisambiguationTest, IsNotDrawnToWhereASurveyHasNotBeen) {
  Building building;
  building.fixtures = kTwoAlike;
  PriorMap surveyed = floor_with_walls({});
  for (std::size_t i = 0; i < surveyed.cells.size(); ++i) {
    const Eigen::Vector2d place = surveyed.geometry.centre_of(
        {static_cast<int>(i) % surveyed.geometry.columns, static_cast<int>(i) / surveyed.geometry.columns});
    surveyed.cells[i] = place.x() < 1.5 ? Prior::kFree : Prior::kUnknown;  // nothing is known around the second pose
  }
  building.fixtures.resize(2);
  const auto far = [&] {
    const Disambiguation disambiguation(CeilingForecast(building, surveyed, 1.2, 0.28));
    return disambiguation.path({Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), {}}, kBelowEither, map_);
  };
  EXPECT_TRUE(far()) << "of a whole building, what is no floor is known to be none";
  building.is_complete = false;
  building.seen_from = {{0.0, 0.0}, {20.0, 0.0}};
  EXPECT_FALSE(far());
}

TEST_F(DisambiguationTest, GoesAroundAWallThatAllHave) {
  const PriorMap walls = floor_with_walls({{{-2, 1.2}, {2, 1.4}}, {{18, 1.2}, {22, 1.4}}});
  const auto found = path(kTwoAlike, walls, kBelowEither);
  ASSERT_TRUE(found);
  double farthest = 0.0;
  for (const Eigen::Vector2d& place : *found) {
    EXPECT_TRUE(std::abs(place.x()) > 2.0 || std::abs(place.y() - 1.3) > 0.2) << place.transpose();
    farthest = std::max(farthest, std::abs(place.x()));
  }
  EXPECT_GT(farthest, 2.0);
}

TEST_F(DisambiguationTest, GoesAroundAWallOfTheLikeliestHoweverManyUnlikelyOnesHaveNone) {
  const PriorMap walls = floor_with_walls({{{-2, 1.2}, {2, 1.4}}});
  for (const int many : {20, 2000}) {
    std::vector<PoseAlternative> alternatives(static_cast<std::size_t>(many), {{20, 0, 0}, 0.1 / many});
    alternatives.front() = {{0, 0, 0}, 0.9};
    const auto found = path(kTwoAlike, walls, alternatives);
    ASSERT_TRUE(found);
    EXPECT_GT(found->back().y(), 1.4);
    for (const Eigen::Vector2d& place : *found) {
      EXPECT_TRUE(std::abs(place.x()) > 2.0 || std::abs(place.y() - 1.3) > 0.2) << many << ": " << place.transpose();
    }
  }
}

/// Sonars at x = -1 to 1 heard something `range` [m] to the left of them.
void hear_to_the_left(SearchMap& map, double range) {
  const std::size_t discs = test_robot().sonar.robot_from_sonar.size();
  std::int64_t utime = 0;
  for (double x = -1.0; x < 1.05; x += 0.1) {
    std::vector<SonarFiring> firings;
    for (std::size_t disc = 0; disc < discs; ++disc) {
      firings.push_back({disc, utime += 1'000, range, true, {x, 0.3, kPi / 2}});
    }
    map.add(firings);
  }
}

TEST_F(DisambiguationTest, GoesAroundAWallThatAllHaveThoughSonarHeardFreeFloorBehindIt) {
  hear_to_the_left(map_, 2.6);
  ASSERT_EQ(map_.ground_at({0.0, 1.3}), Ground::kFree);
  const PriorMap walls = floor_with_walls({{{-2, 1.2}, {2, 1.4}}, {{18, 1.2}, {22, 1.4}}});
  const auto found = path(kTwoAlike, walls, kBelowEither);
  ASSERT_TRUE(found);
  EXPECT_GT(found->back().y(), 1.4);
  for (const Eigen::Vector2d& place : *found) {
    EXPECT_TRUE(std::abs(place.x()) > 2.0 || std::abs(place.y() - 1.3) > 0.2) << place.transpose();
  }
}

TEST_F(DisambiguationTest, LeadsToWhatTellsALikelyPoseFromItsRivalsRatherThanThoseFromEachOther) {
  // to the left half of the unlikely poses see a fixture that the other half has not; to the right the likely one does
  const std::vector<Fixture> fixtures{fixture_at(0, 0), fixture_at(20, 0), fixture_at(20, -3), fixture_at(-10, 0),
                                      fixture_at(-10, 3)};
  std::vector<PoseAlternative> alternatives{{{20, 0, 0}, 0.5}};
  for (int i = 0; i < 5; ++i) {
    alternatives.push_back({{0, 0, 0}, 0.05});
    alternatives.push_back({{-10, 0, 0}, 0.05});
  }
  const auto found = path(fixtures, floor_with_walls({}), alternatives);
  ASSERT_TRUE(found);
  EXPECT_LT(found->back().y(), -1.0) << found->back().transpose();
}

TEST_F(DisambiguationTest, GoesAroundWhatWasFoundShut) {
  for (double x = -1.5; x < 1.6; x += 0.3) {
    map_.shut({x, 1.3});
  }
  const auto found = path(kTwoAlike, floor_with_walls({}), kBelowEither);
  ASSERT_TRUE(found);
  EXPECT_GT(found->back().y(), 2.0);
  for (const Eigen::Vector2d& place : *found) {
    EXPECT_TRUE(std::abs(place.x()) > 1.5 || std::abs(place.y() - 1.3) > 0.2) << place.transpose();
  }
}

TEST_F(DisambiguationTest, DrivesThroughTheDoorOfALikelyPoseThoughItsPostsEcho) {
  hear_to_the_left(map_, 1.0);  // a door's posts, drawn as wide as the beams
  ASSERT_EQ(map_.ground_at({0.0, 1.3}), Ground::kStands);
  // a corridor whose left wall has a door in the likely pose only; its fixture to the left is inside the room
  const PriorMap walls = floor_with_walls({{{-14, 1.2}, {-0.5, 1.4}}, {{0.5, 1.2}, {14, 1.4}}, {{15, 1.2}, {34, 1.4}}});
  const std::vector<PoseAlternative> likely{{{0, 0, 0}, 0.6}, {{20, 0, 0}, 0.2}, {{24, 0, 0}, 0.2}};
  const auto found = path({fixture_at(0, 0), fixture_at(20, 0), fixture_at(24, 0), fixture_at(0, 3)}, walls, likely);
  ASSERT_TRUE(found);
  EXPECT_GT(found->back().y(), 1.0) << found->back().transpose();
  for (const Eigen::Vector2d& place : *found) {
    EXPECT_TRUE(std::abs(place.y() - 1.3) > 0.2 || std::abs(place.x()) < 0.5) << place.transpose();
  }
}

TEST_F(DisambiguationTest, DrivesThroughNoDoorThatOnlyUnlikelyPosesHaveOrThatWasFoundShut) {
  hear_to_the_left(map_, 1.0);
  const PriorMap walls = floor_with_walls({{{-14, 1.2}, {-0.5, 1.4}}, {{0.5, 1.2}, {14, 1.4}}, {{15, 1.2}, {34, 1.4}}});
  const std::vector<Fixture> fixtures{fixture_at(0, 0), fixture_at(20, 0), fixture_at(24, 0), fixture_at(0, 3)};
  const auto leads_in = [](const std::optional<std::vector<Eigen::Vector2d>>& found) {
    return found && std::any_of(found->begin(), found->end(), [](const Eigen::Vector2d& p) { return p.y() > 1.1; });
  };
  EXPECT_FALSE(leads_in(path(fixtures, walls, {{{0, 0, 0}, 0.2}, {{20, 0, 0}, 0.4}, {{24, 0, 0}, 0.4}})));
  for (double x = -0.6; x < 0.7; x += 0.3) {
    map_.shut({x, 1.3});
  }
  EXPECT_FALSE(leads_in(path(fixtures, walls, {{{0, 0, 0}, 0.6}, {{20, 0, 0}, 0.2}, {{24, 0, 0}, 0.2}})));
}

TEST_F(DisambiguationTest, TurnsBackForAPoseThatOneLookTheOtherWayWouldHaveFound) {
  // It began at the origin and has come 2 m to the left. Farther on one of four poses sees a fixture that the others
  // have not; another would have seen one 2 m to the right.
  const std::vector<Fixture> fixtures{fixture_at(-10, 0), fixture_at(-10, 6),   fixture_at(0, 0),
                                      fixture_at(10, 0),  fixture_at(10, -2.5), fixture_at(20, 0)};
  const std::vector<PoseAlternative> alternatives{
      {{-10, 0, 0}, 0.25}, {{0, 0, 0}, 0.25}, {{10, 0, 0}, 0.25}, {{20, 0, 0}, 0.25}};
  Building building;
  building.fixtures = fixtures;
  for (double y = 0.0; y < 3.1; y += 0.2) {
    map_.visit({0.0, y});
  }
  const Disambiguation search(CeilingForecast(building, floor_with_walls({}), 1.2, 0.28));
  const auto found = search.path({{0.0, 2.2}, {0.0, 0.0}, std::nullopt}, alternatives, map_);
  ASSERT_TRUE(found);
  EXPECT_LT(found->back().y(), -1.0) << "the other is nearer from here, but was farther from where it began";
}

TEST_F(DisambiguationTest, KnowsNoPathWhereAllPredictTheSame) {
  const std::vector<Fixture> alike{fixture_at(0, 0), fixture_at(20, 0)};
  EXPECT_FALSE(path(alike, floor_with_walls({}), kBelowEither));
  EXPECT_FALSE(path(kTwoAlike, floor_with_walls({}), {}));
  EXPECT_FALSE(path({}, floor_with_walls({}), kBelowEither));
}

TEST_F(DisambiguationTest, DoesNotLookAgainWhereItHasBeen) {
  for (double y = 0.0; y < 4.0; y += 0.2) {
    map_.visit({0.0, y});
  }
  const auto found = path(kTwoAlike, floor_with_walls({}), kBelowEither);
  EXPECT_TRUE(!found || std::abs(found->back().x()) > 1.0) << found->back().transpose();
}

TEST_F(DisambiguationTest, LeadsAPoseThatIsAloneToAFixtureThatItDidNotPass) {
  // the first is seen well from some steps on too, but only the second says more than is known
  const auto found = path({fixture_at(0, 1), fixture_at(0, -5)}, floor_with_walls({}), {{{0, 0, 0}, 1.0}});
  ASSERT_TRUE(found);
  EXPECT_LT((found->back() - Eigen::Vector2d(0, -5)).norm(), 1.0) << found->back().transpose();
}

TEST_F(DisambiguationTest, StaysWithThePlaceItHeadsForWhileAnotherIsAsGood) {
  const std::vector<Fixture> both{fixture_at(0, 0), fixture_at(20, 0), fixture_at(20, 3), fixture_at(20, -3)};
  for (const double side : {1.0, -1.0}) {
    const auto first = path(both, floor_with_walls({}), kBelowEither, Eigen::Vector2d(0, 2.4 * side));
    ASSERT_TRUE(first);
    EXPECT_GT(first->back().y() * side, 0.0);
  }
}

TEST_F(DisambiguationTest, TakesThousandsOfAlternatives) {
  std::vector<PoseAlternative> many;
  for (int i = 0; i < 5000; ++i) {
    many.push_back(i % 2 == 0 ? kBelowEither[0] : kBelowEither[1]);
  }
  const auto found = path(kTwoAlike, floor_with_walls({}), many);
  ASSERT_TRUE(found);
  EXPECT_LT((found->back() - Eigen::Vector2d(0, 3)).norm(), 1.0);
}

TEST(CeilingForecast, KnowsTheNearestFixtureAndWhereThereIsRoom) {
  Building building;
  building.fixtures = {fixture_at(0, 0), fixture_at(1.5, 0)};
  const CeilingForecast forecast(building, floor_with_walls({{{3, -1}, {3.1, 1}}}), 1.0, 0.28);
  ASSERT_NE(forecast.fixture_above({0.9, 0.0}), nullptr);
  EXPECT_DOUBLE_EQ(forecast.fixture_above({0.9, 0.0})->world_from_fixture.x, 1.5);
  EXPECT_EQ(forecast.fixture_above({0.0, 1.1}), nullptr);
  EXPECT_EQ(forecast.fixture_above({500.0, 0.0}), nullptr);
  EXPECT_FALSE(forecast.has_room({2.85, 0.0}));
  EXPECT_TRUE(forecast.has_room({2.5, 0.0}));
  EXPECT_FALSE(forecast.has_room({500.0, 0.0}));
  EXPECT_TRUE(CeilingForecast(building, PriorMap{}, 1.0, 0.28).has_room({500.0, 0.0}));
  EXPECT_TRUE(forecast.is_beside_wall({2.55, 0.0}));
  EXPECT_FALSE(forecast.is_beside_wall({2.3, 0.0})) << "that is open floor";
  EXPECT_FALSE(forecast.is_beside_wall({2.85, 0.0})) << "no room";
  EXPECT_FALSE(CeilingForecast(building, PriorMap{}, 1.0, 0.28).is_beside_wall({0.0, 0.0}));
}

}  // namespace
}  // namespace luminav
