#include "services/surveyor/explore/exploration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/surveyor/explore/drawn_floor.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000;  // [us]

/// A closed corridor of 6 m; the robot begins at its left end.
OccupancyGrid corridor() {
  std::vector<std::string> rows(10, std::string(34, '#'));
  for (std::size_t row = 2; row < 8; ++row) {
    rows[row] = "##" + std::string(30, '.') + "##";
  }
  return drawn_floor(rows);
}

/// The same of which only so many squares of 0.2 m are known.
OccupancyGrid corridor_known_for(std::size_t squares) {
  std::vector<std::string> rows(10, std::string(34, ' '));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const bool is_wall = row < 2 || row >= 8;
    for (std::size_t column = 0; column < 34 && column < squares; ++column) {
      rows[row][column] = is_wall || column < 2 || column >= 32 ? '#' : '.';
    }
  }
  return drawn_floor(rows);
}

/// A planner that does what it is told, or not.
class ExplorationTest : public testing::Test {
 protected:
  ExplorationTest() { exploration_.begin(); }

  void look(const Pose2& robot) {
    now_ += kSecond;
    ASSERT_TRUE(!exploration_.is_active() || exploration_.is_due(now_));
    if (exploration_.is_active()) {
      exploration_.update(now_, {grid_, looks_, robot, 1});
    }
    if (exploration_.request()) {
      asked_ = *exploration_.request();
    }
  }
  /// The planner takes up what was asked.
  void answer(bool is_over, bool has_arrived) {
    exploration_.hear({asked_.id, is_over, has_arrived, false, asked_.position, has_arrived ? "" : "a wall"});
  }
  /// The robot wants home.
  void find_nothing_more() {
    for (int i = 0; i < 200 && exploration_.phase() != Exploration::Phase::kHome; ++i) {
      looks_ = {{1.0, 1.0}, {2.5, 1.0}, {4.0, 1.0}, {5.5, 1.0}};
      look({1.0, 1.0, 0.0});
      if (exploration_.phase() == Exploration::Phase::kDriving) {
        answer(true, false);
      }
    }
  }

  /// The robot arrives where it began, and looks around there.
  void come_home() {
    answer(true, true);
    for (int i = 0; i < 20; ++i) {
      look({1.0, 1.0, 0.0});
    }
  }

  OccupancyGrid grid_ = corridor();
  std::vector<Eigen::Vector2d> looks_;
  Exploration exploration_{ExplorationParams{}};
  ExploreGoal asked_;
  std::int64_t now_ = kSecond;
};

TEST_F(ExplorationTest, GoesOnUntilAllWasSeenAndDrivesHome) {
  Pose2 robot{1.0, 1.0, 0.0};
  for (int i = 0; i < 200 && exploration_.phase() != Exploration::Phase::kHome; ++i) {
    looks_.push_back(robot.position());
    look(robot);
    if (exploration_.phase() == Exploration::Phase::kDriving) {
      robot = {asked_.position.x(), asked_.position.y(), 0.0};
      answer(true, true);
    }
  }
  ASSERT_EQ(exploration_.phase(), Exploration::Phase::kHome);
  EXPECT_EQ(asked_.position, Eigen::Vector2d::Zero());
  EXPECT_NEAR(exploration_.open_floor().unseen, 0.0, 0.2);
  come_home();
  EXPECT_EQ(exploration_.phase(), Exploration::Phase::kFinished);
  EXPECT_THAT(exploration_.sentence(), HasSubstr("back where it began"));
}

TEST_F(ExplorationTest, AsksUntilThePlannerEchoes) {
  look({1.0, 1.0, 0.0});
  ASSERT_TRUE(exploration_.request());
  answer(false, false);
  EXPECT_FALSE(exploration_.request());
}

TEST_F(ExplorationTest, TriesAPlaceThreeTimesAtMost) {
  std::vector<Eigen::Vector2d> asked;
  for (int i = 0; i < 200 && exploration_.phase() != Exploration::Phase::kHome; ++i) {
    look({1.0, 1.0, 0.0});
    if (exploration_.request() && exploration_.phase() == Exploration::Phase::kDriving) {
      asked.push_back(asked_.position);
      answer(true, false);
    }
  }
  ASSERT_EQ(exploration_.phase(), Exploration::Phase::kHome);
  ASSERT_FALSE(asked.empty());
  for (const Eigen::Vector2d& place : asked) {
    EXPECT_LE(std::count_if(asked.begin(), asked.end(),
                            [&](const Eigen::Vector2d& other) { return (other - place).norm() < 0.05; }),
              3);
  }
}

TEST_F(ExplorationTest, FollowsAnOpenEndThatMovesOn) {
  looks_ = {{1.0, 1.0}, {2.5, 1.0}, {4.0, 1.0}, {5.5, 1.0}};
  std::size_t known = 8;
  for (int i = 0; i < 400 && exploration_.phase() != Exploration::Phase::kHome; ++i) {
    grid_ = corridor_known_for(known);
    const std::int64_t before = asked_.id;
    look({1.0, 1.0, 0.0});
    if (asked_.id != before) {
      ++known;  // going there showed 0.2 m more, and the robot is there
      answer(true, true);
    }
  }
  EXPECT_GE(known, 32u);
}

TEST_F(ExplorationTest, LeavesAloneWhatOpensAgainAndAgain) {
  looks_ = {{1.0, 1.0}, {2.5, 1.0}, {4.0, 1.0}, {5.5, 1.0}};
  int goals = 0;
  for (int i = 0; i < 400 && exploration_.phase() != Exploration::Phase::kHome; ++i) {
    grid_ = corridor_known_for(i % 2 == 0 ? 16 : 18);  // an echo comes and goes
    const std::int64_t before = asked_.id;
    look({1.0, 1.0, 0.0});
    goals += asked_.id != before ? 1 : 0;
    answer(false, false);
  }
  EXPECT_EQ(exploration_.phase(), Exploration::Phase::kHome);
  EXPECT_LT(goals, 40);
}

TEST_F(ExplorationTest, TakesAnotherGoalWhereTheRobotDoesNotMoveOn) {
  look({1.0, 1.0, 0.0});
  const std::int64_t first = asked_.id;
  answer(false, false);
  for (int i = 0; i < 120 && asked_.id == first; ++i) {
    look({1.0, 1.0, 0.0});
    answer(false, false);
  }
  EXPECT_NE(asked_.id, first);
}

TEST_F(ExplorationTest, WaitsForHimWhoHasStoppedTheRobot) {
  look({1.0, 1.0, 0.0});
  const std::int64_t first = asked_.id;
  for (int i = 0; i < 300; ++i) {
    exploration_.hear({first, false, false, true, asked_.position, ""});
    look({1.0, 1.0, 0.0});
  }
  EXPECT_EQ(asked_.id, first);
}

TEST_F(ExplorationTest, GoesOnAfterAPause) {
  look({1.0, 1.0, 0.0});
  const ExploreGoal first = asked_;
  answer(false, false);
  exploration_.hear({first.id + 1, false, false, true, first.position, "paused"});
  for (int i = 0; i < 100; ++i) {
    look({1.0, 1.0, 0.0});
  }
  EXPECT_TRUE(exploration_.is_active());
  EXPECT_FALSE(exploration_.request());
  exploration_.hear({first.id + 2, false, false, false, first.position, ""});
  EXPECT_TRUE(exploration_.is_active());
  exploration_.hear({first.id + 2, true, false, false, first.position, "a wall"});
  look({1.0, 1.0, 0.0});
  look({1.0, 1.0, 0.0});
  EXPECT_GT(asked_.id, first.id + 2);
}

TEST_F(ExplorationTest, EndsWhenSomebodyElseTakesTheRobot) {
  look({1.0, 1.0, 0.0});
  answer(false, false);
  exploration_.hear({asked_.id + 1, true, false, false, {}, "cancelled"});
  EXPECT_FALSE(exploration_.is_active());
  EXPECT_FALSE(exploration_.request());
  EXPECT_THAT(exploration_.sentence(), HasSubstr("somebody else"));
  EXPECT_NE(exploration_.phase(), Exploration::Phase::kFinished);
}

TEST_F(ExplorationTest, CancelsItsGoalWhenItIsToldToEnd) {
  look({1.0, 1.0, 0.0});
  answer(false, false);
  exploration_.end(now_, "enough");
  EXPECT_FALSE(exploration_.is_active());
  ASSERT_TRUE(exploration_.request());
  EXPECT_TRUE(exploration_.request()->is_cancel);
  EXPECT_GT(exploration_.request()->id, asked_.id);
  exploration_.hear({exploration_.request()->id, true, false, false, {}, ""});
  EXPECT_FALSE(exploration_.request());
  EXPECT_EQ(exploration_.sentence(), "enough");
}

TEST_F(ExplorationTest, TriesThreeTimesToComeHome) {
  find_nothing_more();
  for (int tried = 0; tried < 3; ++tried) {
    ASSERT_EQ(exploration_.phase(), Exploration::Phase::kHome);
    answer(true, false);
    look({1.0, 1.0, 0.0});
  }
  EXPECT_EQ(exploration_.phase(), Exploration::Phase::kFinished);
  EXPECT_THAT(exploration_.sentence(), HasSubstr("a wall"));
  EXPECT_TRUE(asked_.is_cancel);
}

TEST_F(ExplorationTest, GoesOnWhenItSeesMoreFromHome) {
  grid_ = corridor_known_for(16);
  for (int row = 0; row < grid_.geometry.rows; ++row) {
    grid_.evidence[grid_.geometry.index({31, row})] = 80;  // a door that echoes drew shut
  }
  find_nothing_more();
  ASSERT_EQ(exploration_.phase(), Exploration::Phase::kHome);
  grid_ = corridor_known_for(16);
  come_home();
  EXPECT_EQ(exploration_.phase(), Exploration::Phase::kDriving);
}

TEST_F(ExplorationTest, IsHomeWhenASecondTrySucceeds) {
  find_nothing_more();
  answer(false, false);
  for (int second = 0; second < 30; ++second) {  // stands still
    look({1.0, 1.0, 0.0});
  }
  come_home();
  EXPECT_EQ(exploration_.phase(), Exploration::Phase::kFinished);
  EXPECT_THAT(exploration_.sentence(), HasSubstr("back where it began"));
}

}  // namespace
}  // namespace luminav
