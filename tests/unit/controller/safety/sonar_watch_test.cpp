#include "services/controller/safety/sonar_watch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>

#include "services/controller/safety/facing_wall.hpp"
#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

const SonarRing kRing = testing::test_robot().sonar;
constexpr std::size_t kAhead = 3;  // looks 10 degrees to the left
constexpr std::size_t kLeft = 0;

/// What a disc measures when the robot stands somewhere; the maximum range where nothing echoes.
using Hearing = std::function<double(std::size_t disc, const Pose2& odom_from_robot)>;

/// Drives the ring through a world that is known only by what it hears.
struct Drive {
  SonarWatch watch{kRing};
  Pose2 robot{};
  std::int64_t utime = 1'000'000;
  Hearing hear = [](std::size_t, const Pose2&) { return kRing.maximum_range; };
  std::function<SonarWatch::Place(std::size_t, const Pose2&)> look = [](std::size_t, const Pose2&) {
    return SonarWatch::Place{};
  };

  /// One round of the ring each 0.32 s.
  void go(double metres, double turn = 0.0, double speed = 0.5) {
    const int rounds = static_cast<int>(std::max(metres / speed, std::abs(turn) / 0.5) / 0.32 + 0.5);
    for (int i = 0; i < rounds; ++i) {
      robot = robot * Pose2{metres / rounds, 0.0, turn / rounds};
      utime += 320'000;
      for (std::size_t disc = 0; disc < kRing.robot_from_sonar.size(); ++disc) {
        const double range = hear(disc, robot);
        watch.add({disc, utime, range, range < kRing.maximum_range, robot}, look(disc, robot));
      }
    }
  }
};

/// A corridor along x, 2 m wide, with a wall across it at x = 20; side discs hear the sides, all that look ahead the
/// end.
double corridor(std::size_t disc, const Pose2& robot) {
  const Pose2 sonar = robot * kRing.robot_from_sonar[disc];
  const double side = std::abs(wrap_angle(sonar.theta));
  if (std::abs(side - 0.5 * kPi) < radians(15.0)) {
    return sonar.theta > 0.0 ? 1.0 - sonar.y : 1.0 + sonar.y;
  }
  const double end = 20.0 - sonar.x;
  return side < radians(15.0) && end < 4.0 ? end : kRing.maximum_range;
}

SonarWatch::Place corridor_map(std::size_t disc, const Pose2& robot) {
  const double range = corridor(disc, robot);
  return {true, range < 2.0 ? std::optional(range) : std::nullopt};
}

TEST(SonarWatch, TrustsARingThatHearsTheWallsOfItsMap) {
  Drive drive{.hear = corridor, .look = corridor_map};
  drive.go(19.0);
  drive.go(0.0, kPi);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kTrusted);
  EXPECT_EQ(drive.watch.reason(), "");
}

TEST(SonarWatch, TrustsALongCorridorWhoseSidesStayAsFarAway) {
  Drive drive{.hear = corridor};  // no map
  drive.go(15.0);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kTrusted);
}

TEST(SonarWatch, DoubtsADeafRingBesideWallsAndCountsItAsDeadWithinHalfAMetre) {
  Drive drive{.hear = corridor, .look = corridor_map};
  drive.go(2.0);
  drive.hear = [](std::size_t, const Pose2&) { return kRing.maximum_range; };
  drive.go(0.3);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDoubted);
  EXPECT_EQ(drive.watch.reason(), "sonars 0, 7, 8 and 15 heard nothing where walls must be: it drives slowly");
  drive.go(0.2);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDead);
}

TEST(SonarWatch, StandsSoonerWhenBothHalvesAreDeafThanWhenOneIs) {
  const auto distance_until_dead = [](const std::function<bool(std::size_t)>& is_deaf) {
    Drive drive;
    drive.hear = corridor;
    drive.look = corridor_map;
    drive.go(15.0);
    drive.hear = [&](std::size_t disc, const Pose2& robot) {
      return is_deaf(disc) ? kRing.maximum_range : corridor(disc, robot);
    };
    double distance = 0.0;
    for (; distance < 3.0 && drive.watch.trust() != SonarTrust::kDead; distance += 0.05) {
      drive.go(0.05, 0.0, 0.15);
    }
    return distance;
  };
  const double one_half = distance_until_dead([](std::size_t disc) { return kRing.robot_from_sonar[disc].x >= 0.0; });
  const double ring = distance_until_dead([](std::size_t) { return true; });
  EXPECT_LT(one_half, 1.0);
  EXPECT_LT(ring, 0.7 * one_half);
}

TEST(SonarWatch, DoubtsASingleDeafDiscAndLeavesItToItsNeighbours) {
  Drive drive{.look = corridor_map};
  drive.hear = [](std::size_t disc, const Pose2& robot) {
    return disc == kLeft ? kRing.maximum_range : corridor(disc, robot);
  };
  drive.go(10.0);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDoubted);
  EXPECT_EQ(drive.watch.reason(), "sonar 0 heard nothing where walls must be: it drives slowly");
}

TEST(SonarWatch, NoticesRangesThatDoNotChangeOverOwnMotionWithoutAMap) {
  Drive drive;
  drive.hear = [](std::size_t, const Pose2&) { return 3.0; };
  drive.go(0.5);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDoubted);
  EXPECT_NE(drive.watch.reason().find("measured the same while the robot moved"), std::string::npos);
  drive.go(0.8);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDead);
}

TEST(SonarWatch, NoticesAHalfThatIsSilentOverAWholeWayWithoutAMap) {
  Drive drive{.hear = corridor};
  drive.go(3.0);
  drive.hear = [](std::size_t disc, const Pose2& robot) {
    return disc < 8 ? kRing.maximum_range : corridor(disc, robot);
  };
  drive.go(3.5);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kTrusted);  // a hall may be like that
  drive.go(2.0);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDead);
}

TEST(SonarWatch, ExpectsNothingInAHallWhoseWallsAreFarOnTheMap) {
  Drive drive{.look = [](std::size_t, const Pose2&) { return SonarWatch::Place{true, std::nullopt}; }};
  drive.go(30.0);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kTrusted);
}

TEST(SonarWatch, LearnsNothingFromOnePlace) {
  Drive drive{.look = corridor_map};
  for (int i = 0; i < 200; ++i) {
    drive.go(0.005);
    drive.robot = {};
  }
  EXPECT_LE(drive.watch.evidence(kLeft), 1.0);
}

TEST(SonarWatch, TrustsADiscAgainThatHearsSomethingNew) {
  Drive drive{.look = corridor_map};
  drive.go(3.0);
  ASSERT_EQ(drive.watch.trust(), SonarTrust::kDead);
  drive.look = [](std::size_t, const Pose2&) { return SonarWatch::Place{}; };
  std::mt19937 random(3);
  drive.hear = [&](std::size_t, const Pose2&) { return std::uniform_real_distribution(0.3, 2.0)(random); };
  for (int i = 0; i < 4; ++i) {
    drive.go(0.16);  // somebody moves about before it
  }
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kTrusted);
}

TEST(SonarWatch, LetsARobotGoOnWhoseStuckDiscsHearNothingAfterwards) {
  Drive drive;
  drive.hear = [](std::size_t, const Pose2&) { return 3.0; };
  drive.go(1.6);
  ASSERT_EQ(drive.watch.trust(), SonarTrust::kDead);
  drive.hear = [](std::size_t, const Pose2&) { return kRing.maximum_range; };  // it stands in the middle of a hall
  drive.go(0.0, 0.16);
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDoubted) << "so it may drive on, slowly";
}

TEST(SonarWatch, KeepsWhatItFoundOutOverANewSessionOfTheOdometry) {
  Drive drive{.look = corridor_map};
  drive.go(3.0);
  drive.watch.forget_motion();
  EXPECT_EQ(drive.watch.trust(), SonarTrust::kDead);
}

// ------------------------------------------------------------------------------------------- a real ring's recording

constexpr std::array<double, 8> kDirections = {-90.0, -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90.0};  // [degrees]

std::vector<std::vector<double>> numbers_of(const std::string& name) {
  std::ifstream in(std::string(LUMINAV_SOURCE_DIR) + "/tests/data/sonar_corridor/" + name);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0.0; words >> value;) {
      row.push_back(value);
    }
    rows.push_back(row);
  }
  return rows;
}

/// The corridor of the recording: its two walls as fitted to the side echoes of x = 0.5 to 10 m.
OccupancyGrid real_corridor() {
  OccupancyGrid grid({0.1, {-2.0, -2.0}, 135, 40});
  for (int row = 0; row < grid.geometry.rows; ++row) {
    for (int column = 0; column < grid.geometry.columns; ++column) {
      const Eigen::Vector2d centre = grid.geometry.centre_of({column, row});
      const double right = -0.906 + std::tan(radians(0.33)) * centre.x();
      const bool is_between = centre.y() > right && centre.y() < 1.189;
      const bool is_wall = !is_between && centre.y() > right - 0.2 && centre.y() < 1.389;
      grid.prior[grid.geometry.index({column, row})] = is_between ? Prior::kFree
                                                       : is_wall  ? Prior::kOccupied
                                                                  : Prior::kUnknown;
    }
  }
  return grid;
}

struct RecordedTrust {
  double most;  // evidence against a disc
  bool is_trusted;
};
RecordedTrust judge_recording(bool has_map, bool is_deaf) {
  SonarRing ring;
  for (const double direction : kDirections) {
    ring.robot_from_sonar.push_back({0.0, 0.0, radians(direction)});
  }
  SonarWatch watch(ring);
  const OccupancyGrid grid = real_corridor();
  const auto ranges = numbers_of("measurement.txt");
  const auto poses = numbers_of("poses.txt");
  double most = 0.0;
  bool is_trusted = true;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Pose2 robot{poses[i][1] * 1e-3, poses[i][2] * 1e-3, wrap_angle(radians(0.1 * poses[i][3]))};
    for (std::size_t disc = 0; disc < ring.robot_from_sonar.size(); ++disc) {
      const double range = is_deaf ? 5.11 : ranges[i][disc + 1] * 1e-3;
      const Pose2 sonar = robot * ring.robot_from_sonar[disc];
      const bool is_known = has_map && sonar.x > 0.4 && sonar.x < 10.5;
      const auto wall = is_known ? facing_wall(grid, sonar, ring.half_angle, SonarWatch::kWall) : std::nullopt;
      watch.add({disc, static_cast<std::int64_t>(1e3 * ranges[i][0]), range, range < 5.0, robot}, {is_known, wall});
      most = std::max(most, watch.evidence(disc));
      is_trusted = is_trusted && watch.trust() == SonarTrust::kTrusted;
    }
  }
  return {most, is_trusted};
}

TEST(SonarWatch, HasNoDoubtOfARealRingInACorridor) {
  std::printf("most evidence against a disc: %.0f with a map, %.0f without\n", judge_recording(true, false).most,
              judge_recording(false, false).most);
  EXPECT_TRUE(judge_recording(true, false).is_trusted);
  EXPECT_TRUE(judge_recording(false, false).is_trusted);
  EXPECT_EQ(judge_recording(true, true).most, SonarWatch::kDead);
  EXPECT_EQ(judge_recording(false, true).most, SonarWatch::kDead);
}

// --------------------------------------------------------------------------------------------------- walls that face

/// 4 x 4 m, solid from x = 3 on.
OccupancyGrid room() {
  OccupancyGrid grid({0.1, {0.0, 0.0}, 40, 40});
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      grid.prior[grid.geometry.index({column, row})] = column < 30 ? Prior::kFree : Prior::kOccupied;
    }
  }
  return grid;
}

TEST(FacingWall, TellsTheDistanceToAWallMetSquareOn) {
  const auto wall = facing_wall(room(), {1.5, 2.0, 0.0}, radians(15.0), 2.0);
  ASSERT_TRUE(wall);
  EXPECT_NEAR(*wall, 1.5, 0.05);
}

TEST(FacingWall, ExpectsNoEchoOfAWallAtASlantOrFarAway) {
  EXPECT_FALSE(facing_wall(room(), {1.5, 2.0, radians(25.0)}, radians(15.0), 2.0));
  EXPECT_FALSE(facing_wall(room(), {0.5, 2.0, 0.0}, radians(15.0), 2.0));
  EXPECT_FALSE(facing_wall(room(), {1.5, 2.0, kPi}, radians(15.0), 2.0));
}

TEST(FacingWall, ExpectsNoEchoWhereTheMapIsDisputedOrUnknown) {
  OccupancyGrid grid = room();
  for (const Prior prior : {Prior::kDisputed, Prior::kUnknown}) {
    for (int row = 0; row < 40; ++row) {
      grid.prior[grid.geometry.index({25, row})] = prior;
    }
    EXPECT_FALSE(facing_wall(grid, {1.5, 2.0, 0.0}, radians(15.0), 2.0));
  }
}

TEST(FacingWall, ExpectsNoEchoOfAnOpenDoorway) {
  OccupancyGrid grid = room();
  for (int row = 17; row < 23; ++row) {
    for (int column = 30; column < 40; ++column) {
      grid.prior[grid.geometry.index({column, row})] = Prior::kFree;
    }
  }
  EXPECT_FALSE(facing_wall(grid, {1.5, 2.0, 0.0}, radians(15.0), 2.0));
}

}  // namespace
}  // namespace luminav
