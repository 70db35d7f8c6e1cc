#include "services/mapper/grid_mapper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace luminav {
namespace {

constexpr std::int64_t kRound = 320'000;  // [us] from one reading of a disc to its next

PriorMap room(Prior inside = Prior::kFree) {
  // 10 x 10 m, walls 0.2 m thick all round
  PriorMap map{{0.1, {0.0, 0.0}, 100, 100}, std::vector<Prior>(10000, inside)};
  if (inside == Prior::kFree) {
    for (int i = 0; i < 100; ++i) {
      for (int k = 0; k < 2; ++k) {
        for (const Cell cell : {Cell{i, k}, {i, 99 - k}, {k, i}, {99 - k, i}}) {
          map.cells[map.geometry.index(cell)] = Prior::kOccupied;
        }
      }
    }
  }
  return map;
}

/// A sonar in the robot's middle; readings come one round apart.
class Beam {
 public:
  explicit Beam(GridMapper& mapper) : mapper_(mapper) {}
  void look(const Pose2& pose, double range, int times, bool has_echo = true) {
    for (int i = 0; i < times; ++i) {
      utime_ += kRound;
      mapper_.integrate({0, utime_, pose, pose, range, has_echo});
      mapper_.decay(utime_);
    }
  }
  std::int64_t utime() const { return utime_; }

 private:
  GridMapper& mapper_;
  std::int64_t utime_ = 1'000'000;
};

bool occupied(const GridMapper& mapper, double x, double y) {
  return mapper.is_occupied(mapper.grid().geometry.cell_at({x, y}));
}
Prior prior(const GridMapper& mapper, double x, double y) {
  return mapper.grid().prior[mapper.grid().geometry.index(mapper.grid().geometry.cell_at({x, y}))];
}

TEST(GridMapper, DrawsABoxAfterAFewEchoes) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({4.0, 5.0, 0.0}, 1.5, 4);
  EXPECT_TRUE(occupied(mapper, 5.53, 5.05));
  EXPECT_FALSE(occupied(mapper, 4.75, 5.05));
}

TEST(GridMapper, DoesNotBelieveASingleEcho) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  beam.look({4.0, 5.0, 0.0}, 1.5, 1);
  beam.look({4.0, 5.0, 0.0}, 3.5, 3);
  EXPECT_FALSE(occupied(mapper, 5.53, 5.05));
}

TEST(GridMapper, TakesAnEchoFromAWallOfTheMapForThatWall) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  // the pose is 8 cm wrong: the echo seems to come from before the wall
  for (double y = 3.0; y < 7.0; y += 0.1) {
    beam.look({8.0, y, 0.0}, 1.72, 2);
  }
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      const std::size_t i = mapper.grid().geometry.index({column, row});
      EXPECT_FALSE(mapper.is_occupied({column, row}) && mapper.grid().prior[i] == Prior::kFree);
    }
  }
}

TEST(GridMapper, SeesWhatStandsClearlyBeforeAWall) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({7.5, 5.0, 0.0}, 1.7, 4);  // 0.6 m before the wall
  EXPECT_TRUE(occupied(mapper, 9.23, 5.05));
}

TEST(GridMapper, ForgetsAPersonWithinTenSecondsOfSeeingThePlaceFree) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  beam.look({4.0, 5.0, 0.0}, 1.5, 12);
  ASSERT_TRUE(occupied(mapper, 5.53, 5.05));
  const std::int64_t left = beam.utime();
  while (occupied(mapper, 5.53, 5.05) && beam.utime() - left < 20'000'000) {
    beam.look({4.0, 5.0, 0.0}, 4.0, 1);
  }
  EXPECT_LE(beam.utime() - left, 10'000'000);
}

/// A ring of 16 discs round a robot that stands still, and one round thing before it, or nothing.
class StandingRing {
 public:
  StandingRing(GridMapper& mapper, const Pose2& world_from_robot)
      : mapper_(mapper), world_from_robot_(world_from_robot) {}
  void look(double seconds, const std::function<std::optional<Eigen::Vector2d>(double)>& thing_at) {
    for (double t = 0.0; t < seconds; t += 1e-6 * kFiring) {
      utime_ += kFiring;
      disc_ = (disc_ + 7) % 16;
      const double angle = (disc_ + 0.5) * 2.0 * kPi / 16;
      const Pose2 world_from_sonar = world_from_robot_ * Pose2{kRing * std::cos(angle), kRing * std::sin(angle), angle};
      double range = 5.0;
      if (const std::optional<Eigen::Vector2d> thing = thing_at(t)) {
        const Eigen::Vector2d offset = world_from_sonar.inverse() * *thing;
        if (std::abs(std::atan2(offset.y(), offset.x())) <
            radians(15.0) + std::asin(std::min(1.0, kThing / offset.norm()))) {
          range = offset.norm() - kThing;
        }
      }
      mapper_.integrate({disc_, utime_, world_from_robot_, world_from_sonar, range, range < 5.0});
      mapper_.decay(utime_);
    }
  }

 private:
  static constexpr std::int64_t kFiring = kRound / 16;
  static constexpr double kRing = 0.2;   // [m]
  static constexpr double kThing = 0.2;  // [m] its radius
  GridMapper& mapper_;
  Pose2 world_from_robot_;
  std::int64_t utime_ = 1'000'000;
  int disc_ = 0;
};

int occupied_where_the_map_says_free(const GridMapper& mapper) {
  int count = 0;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      const std::size_t i = mapper.grid().geometry.index({column, row});
      count += mapper.is_occupied({column, row}) && mapper.grid().prior[i] == Prior::kFree ? 1 : 0;
    }
  }
  return count;
}

TEST(GridMapper, ForgetsThatSomebodyWalkedPastAtArmsLengthAgainAndAgain) {
  // the trail is a line seen at a slant, which must not pass for a smooth wall that throws the sound away
  GridMapper mapper({}, room(), 16);
  StandingRing ring(mapper, {5.0, 5.0, radians(-40.0)});
  const auto walker = [](double t) { return std::optional(Eigen::Vector2d(4.0 + 0.9 * t, 5.0 - 0.9 * t + 1.6)); };
  int max = 0;
  for (int passage = 0; passage < 6; ++passage) {
    for (double t = 0.0; t < 3.5; t += 0.5) {
      ring.look(0.5, [&](double since) { return walker(t + since); });
      max = std::max(max, occupied_where_the_map_says_free(mapper));
    }
    ring.look(8.0, [](double) { return std::nullopt; });
  }
  EXPECT_GT(max, 0);
  ring.look(2.0, [](double) { return std::nullopt; });
  EXPECT_EQ(occupied_where_the_map_says_free(mapper), 0);
}

TEST(GridMapper, ForgetsThatSomebodyStoodBesideTheRobot) {
  GridMapper mapper({}, room(), 16);
  StandingRing ring(mapper, {5.0, 5.0, radians(-40.0)});
  ring.look(20.0, [](double) { return std::optional(Eigen::Vector2d(5.2, 5.55)); });
  EXPECT_GT(occupied_where_the_map_says_free(mapper), 1);
  ring.look(10.0, [](double) { return std::nullopt; });
  EXPECT_EQ(occupied_where_the_map_says_free(mapper), 0);
}

TEST(GridMapper, KeepsABoxThatItDrivesAlong) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  for (double y = 4.0; y < 6.0; y += 0.1) {
    beam.look({4.0, y, 0.0}, 1.5, 3);  // its face, squarely
  }
  for (int i = 0; i < 10; ++i) {
    beam.look({5.0, 3.0 + 0.1 * i, radians(70.0)}, 4.5, 1);  // past it, at a slant: silence proves nothing
  }
  EXPECT_TRUE(occupied(mapper, 5.53, 5.05));
}

// a gap in a cupboard across a corridor would call the robot from one end of it to the other
TEST(GridMapper, KeepsALongFrontHoweverLongItStandsBesideOneEnd) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  for (int i = 0; i <= 20; ++i) {
    beam.look({5.0, 3.0 + 0.1 * i, 0.0}, 1.0, 4);
  }
  ASSERT_TRUE(occupied(mapper, 6.05, 3.75));
  for (int i = 0; i < 60; ++i) {
    beam.look({5.55, 3.2, radians(40.0 + i % 3 * 10.0)}, 4.0, 1);
  }
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(occupied(mapper, 6.05, 3.55 + 0.1 * i)) << 3.55 + 0.1 * i;
  }
}

TEST(GridMapper, ForgetsAPhantomAlsoWhenNothingAnswersThereAnyMore) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  beam.look({4.0, 5.0, 0.0}, 1.0, 12);
  ASSERT_TRUE(occupied(mapper, 5.03, 5.05));
  beam.look({4.0, 5.0, 0.0}, 5.0, 60, false);
  EXPECT_FALSE(occupied(mapper, 5.03, 5.05));
}

TEST(GridMapper, LetsOccupiedEvidenceFadeThatContradictsTheMap) {
  GridMapperParams params;
  params.decay_time = 60.0;
  GridMapper known(params, room(), 16);
  GridMapper unknown(params, room(Prior::kUnknown), 16);
  for (GridMapper* mapper : {&known, &unknown}) {
    Beam beam(*mapper);
    beam.look({4.0, 5.0, 0.0}, 1.5, 12);
    for (std::int64_t utime = beam.utime(); utime < beam.utime() + 70'000'000; utime += 100'000) {
      mapper->decay(utime);
    }
  }
  EXPECT_FALSE(occupied(known, 5.53, 5.05));
  EXPECT_TRUE(occupied(unknown, 5.53, 5.05)) << "where the building's map says nothing, the sonars' word stays";
}

TEST(GridMapper, IgnoresReadingsBelowTheMinimum) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({4.0, 5.0, 0.0}, 0.05, 10);
  EXPECT_TRUE(mapper.take_touched_tiles().empty());
}

TEST(GridMapper, TakesAReadingAtTheMaximumForNoEcho) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({3.0, 5.0, 0.0}, 5.0, 20, true);
  EXPECT_FALSE(occupied(mapper, 8.03, 5.05));
}

TEST(GridMapper, LetsSilenceTakeAwayOnlyWhatWouldHaveAnsweredWhereNoMapIsKnown) {
  const PriorMap map = room(Prior::kUnknown);
  OccupancyGrid drawn(map.geometry);
  drawn.evidence[map.geometry.index({50, 20})] = 60;  // alone: it may be a bit of a slanted wall, which is a mirror
  for (int row = 76; row < 85; ++row) {
    drawn.evidence[map.geometry.index({50, row})] = 60;  // a surface, and seen from right before it
  }
  GridMapper mapper({}, map, 16);
  ASSERT_TRUE(mapper.restore_evidence(drawn));
  Beam beam(mapper);
  beam.look({4.0, 2.05, 0.0}, 5.0, 100, false);
  beam.look({4.0, 8.05, 0.0}, 5.0, 100, false);
  EXPECT_TRUE(occupied(mapper, 5.05, 2.05));
  EXPECT_FALSE(occupied(mapper, 5.05, 8.05));
}

TEST(GridMapper, LetsFarEchoesTakeAwayNoMoreThanSilenceWhereNoMapIsKnown) {
  const PriorMap map = room(Prior::kUnknown);
  OccupancyGrid drawn(map.geometry);
  drawn.evidence[map.geometry.index({50, 20})] = 60;  // alone
  drawn.evidence[map.geometry.index({50, 50})] = 60;
  for (int row = 76; row < 85; ++row) {
    drawn.evidence[map.geometry.index({50, row})] = 60;  // a surface, and seen from right before it
  }
  GridMapper mapper({}, map, 16);
  ASSERT_TRUE(mapper.restore_evidence(drawn));
  Beam beam(mapper);
  beam.look({4.0, 2.05, 0.0}, 3.5, 100);
  beam.look({4.0, 5.05, 0.0}, 2.5, 100);
  beam.look({4.0, 8.05, 0.0}, 3.5, 100);
  EXPECT_TRUE(occupied(mapper, 5.05, 2.05));
  EXPECT_FALSE(occupied(mapper, 5.05, 5.05)) << "an echo from so near means what it says";
  EXPECT_FALSE(occupied(mapper, 5.05, 8.05));
}

TEST(GridMapper, KeepsEachFaceOfAWallThatItPassesAtASlant) {
  const PriorMap map = room(Prior::kUnknown);
  OccupancyGrid drawn(map.geometry);
  for (int column = 10; column < 90; ++column) {
    drawn.evidence[map.geometry.index({column, 50})] = 60;
    drawn.evidence[map.geometry.index({column, 53})] = 60;  // the other side of the same wall
  }
  GridMapper mapper({}, map, 16);
  ASSERT_TRUE(mapper.restore_evidence(drawn));
  // by a mirror: what answers seems to lie behind the wall
  Beam(mapper).look({3.0, 4.6, radians(30.0)}, 2.0, 100);
  for (int column = 30; column < 60; ++column) {
    EXPECT_TRUE(mapper.is_occupied({column, 50})) << "column " << column;
    EXPECT_TRUE(mapper.is_occupied({column, 53})) << "column " << column;
  }
}

TEST(GridMapper, CountsEchoesFromAfarForLessWhereNoMapIsKnown) {
  const auto evidence_with = [](double mirror_range) {
    GridMapperParams params;
    params.mirror_range = mirror_range;
    GridMapper mapper(params, room(Prior::kUnknown), 16);
    Beam(mapper).look({4.0, 5.05, 0.0}, 2.53, 2);
    return mapper.grid().evidence[mapper.grid().geometry.index(mapper.grid().geometry.cell_at({6.55, 5.05}))];
  };
  const int near = evidence_with(3.0);
  const int far = evidence_with(2.0);
  EXPECT_GT(far, 0);
  EXPECT_NEAR(far, GridMapperParams{}.mirror_share * near, 1.0);
}

TEST(GridMapper, DoesNotDrawFreeSpaceThroughAWallOfTheMap) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({8.5, 5.0, 0.9}, 5.0, 50, false);
  EXPECT_EQ(mapper.grid().evidence[mapper.grid().geometry.index({99, 68})], 0);
}

TEST(GridMapper, DisputesAWallThatIsSeenThroughFromThreePlaces) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  beam.look({8.6, 5.05, 0.0}, 3.0, 5);
  EXPECT_EQ(prior(mapper, 9.85, 5.05), Prior::kOccupied) << "one place";
  beam.look({8.1, 5.05, 0.0}, 3.5, 5);
  EXPECT_EQ(prior(mapper, 9.85, 5.05), Prior::kOccupied) << "two places";
  beam.look({8.05, 5.05, 0.0}, 3.5, 5);
  EXPECT_EQ(prior(mapper, 9.85, 5.05), Prior::kOccupied) << "too near the second";
}

TEST(GridMapper, CountsPlacesForADisputeOnlyHalfAMetreApart) {
  PriorMap map = room();
  for (int row = 30; row < 70; ++row) {
    map.cells[map.geometry.index({50, row})] = Prior::kOccupied;  // a wall in the middle that is no longer there
  }
  GridMapper mapper({}, map, 16);
  Beam beam(mapper);
  for (const double x : {4.6, 4.05, 3.5}) {
    EXPECT_EQ(prior(mapper, 5.05, 5.05), Prior::kOccupied);
    beam.look({x, 5.05, 0.0}, 4.0, 3);
  }
  EXPECT_EQ(prior(mapper, 5.05, 5.05), Prior::kDisputed);
  EXPECT_EQ(prior(mapper, 5.05, 6.5), Prior::kOccupied);
}

TEST(GridMapper, KnowsThatNothingStandsWhereTheRobotStands) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({4.0, 5.0, 0.0}, 1.5, 12);
  ASSERT_TRUE(occupied(mapper, 5.53, 5.05));
  for (int i = 0; i < 5; ++i) {
    mapper.mark_robot({5.5, 5.0, 0.0});
  }
  EXPECT_FALSE(occupied(mapper, 5.53, 5.05));
}

TEST(GridMapper, TellsWhichTilesItTouched) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({2.0, 2.0, 0.0}, 1.5, 1);
  EXPECT_EQ(mapper.take_touched_tiles(), std::vector<int>({0}));
  EXPECT_TRUE(mapper.take_touched_tiles().empty());
  Beam(mapper).look({6.4, 6.4, 0.0}, 1.5, 1);
  EXPECT_EQ(mapper.take_touched_tiles().size(), 4U);
}

TEST(GridMapper, ClearsAllEvidence) {
  GridMapper mapper({}, room(), 16);
  Beam(mapper).look({4.0, 5.0, 0.0}, 1.5, 4);
  mapper.clear_evidence();
  for (const std::int8_t evidence : mapper.grid().evidence) {
    ASSERT_EQ(evidence, 0);
  }
}

TEST(GridMapper, DoesNotKnowWhatLiesBehindAWallThatItDraws) {
  GridMapper mapper({}, room(Prior::kUnknown), 16);
  Beam beam(mapper);
  const auto evidence = [&](double x) {
    return mapper.grid().evidence[mapper.grid().geometry.index(mapper.grid().geometry.cell_at({x, 5.05}))];
  };
  beam.look({4.0, 5.05, 0.0}, 2.5, 20);  // by a mirror that was no wall yet
  ASSERT_LT(evidence(5.25), 0);
  for (double x = 4.0; x < 4.5; x += 0.06) {
    beam.look({x, 5.05, 0.0}, 5.05 - x, 2);
  }
  EXPECT_TRUE(occupied(mapper, 5.05, 5.05));
  EXPECT_GE(evidence(5.15), 0);
  EXPECT_GE(evidence(5.25), 0) << "walls are thicker than a cell";
  EXPECT_LT(evidence(4.45), 0);
}

TEST(GridMapper, SurvivesPosesFarOutsideTheMap) {
  GridMapper mapper({}, room(), 16);
  Beam beam(mapper);
  beam.look({-500.0, 3.0, 1.0}, 1.5, 3);
  beam.look({9.9, 9.9, 0.7}, 4.5, 3);
  beam.look({1e9, -1e9, 0.7}, 4.5, 3);
  mapper.mark_robot({1e9, 0.0, 0.0});
  SUCCEED();
}

}  // namespace
}  // namespace luminav
