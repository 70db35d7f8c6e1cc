#include "services/jobs/watches/guide_watch.hpp"

#include <gtest/gtest.h>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

using Advice = GuideWatch::Advice;

/// One disc that looks straight behind.
Echo behind_it(const Pose2& robot, double range) {
  return {robot * Pose2{-0.25, 0.0, kPi}, radians(15.0), range};
}

/// A guide that drives 0.4 m/s while it leads, and what it hears behind.
class Walk {
 public:
  /// `behind(driven)` is the range [m] of the nearest echo; below 0 = none.
  template <typename Ranges>
  Advice walk(double seconds, Ranges behind) {
    Advice last = Advice::kNone;
    for (double t = 0.0; t < seconds - 1e-9 && last == Advice::kNone; t += 0.2) {
      const double step = guide.leads() ? 0.08 : 0.0;
      x += step;
      const double range = behind(x);
      const Pose2 robot{x, 0.0, 0.0};
      last = guide.update(
          {0.2, step, range > 0.0 ? std::vector{behind_it(robot, range)} : std::vector<Echo>{}, robot, arrived});
    }
    return last;
  }

  GuideWatch guide{GuideParams{}, nullptr};
  double x = 0.0;  // [m] driven
  bool arrived = false;
};

TEST(GuideWatch, LeadsAsLongAsSomebodyKeepsHisDistance) {
  Walk walk;
  EXPECT_EQ(walk.walk(60.0, [](double) { return 1.2; }), Advice::kNone);
  EXPECT_TRUE(walk.guide.leads());
}

TEST(GuideWatch, SlowsDownForAVisitorWhoFallsBack) {
  Walk walk;
  walk.walk(10.0, [](double) { return 1.0; });
  EXPECT_DOUBLE_EQ(walk.guide.max_speed(), 0.4) << "at walking pace as long as he is there";
  double before = 0.4;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(walk.walk(1.4, [](double) { return -1.0; }), Advice::kNone);
    EXPECT_LT(walk.guide.max_speed(), before);
    before = walk.guide.max_speed();
  }
  EXPECT_GT(before, 0.16);
  walk.walk(1.0, [](double) { return 1.0; });
  EXPECT_DOUBLE_EQ(walk.guide.max_speed(), 0.4) << "he has caught up";
}

TEST(GuideWatch, TakesAWallThatFallsBackForNobody) {
  Walk walk;
  EXPECT_EQ(walk.walk(20.0, [](double x) { return 0.5 + x; }), Advice::kWait);
  EXPECT_LT(walk.x, 3.4);
}

TEST(GuideWatch, TakesAWallBesideItsWayForNobody) {
  Walk walk;
  walk.walk(10.0, [](double) { return 1.0; });
  GuideWatch& guide = walk.guide;
  // round a corner: what is straight behind it now it has not driven through
  GuideWatch::Advice last = Advice::kNone;
  double y = 0.0;
  for (int i = 0; i < 50 && last == Advice::kNone; ++i) {
    y += 0.08;
    const Pose2 robot{walk.x, y, 0.5 * kPi};
    last = guide.update({0.2, 0.08, {behind_it(robot, y + 0.8)}, robot, false});
  }
  EXPECT_EQ(last, Advice::kWait);
}

TEST(GuideWatch, SeesAtOnceWhoStandsBehindItWhenItStops) {
  Walk walk;
  ASSERT_EQ(walk.walk(20.0, [](double) { return -1.0; }), Advice::kWait);
  EXPECT_EQ(walk.walk(1.0, [](double) { return 0.5; }), Advice::kLeadOn);
}

TEST(GuideWatch, WaitsForWhoFellBackAndLeadsOnWhenHeComesNear) {
  Walk walk;
  walk.walk(10.0, [](double) { return 1.0; });
  const double lost_at = walk.x;
  ASSERT_EQ(walk.walk(20.0, [](double) { return -1.0; }), Advice::kWait);
  EXPECT_NEAR(walk.x - lost_at, 2.0, 0.2);
  EXPECT_EQ(walk.guide.sentence(), "waits for its visitor");
  double range = 2.4;
  EXPECT_EQ(walk.walk(5.0, [&](double) { return range -= 0.1; }), Advice::kLeadOn);
  EXPECT_TRUE(walk.guide.leads());
}

TEST(GuideWatch, GoesBackTwiceThenGivesUp) {
  Walk walk;
  walk.walk(10.0, [](double) { return 1.0; });
  const auto nobody = [](double) { return -1.0; };
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(walk.walk(20.0, nobody), Advice::kWait);
    ASSERT_EQ(walk.walk(20.0, nobody), Advice::kGoBack);
    EXPECT_EQ(walk.guide.sentence(), "goes back for its visitor");
    walk.arrived = true;
    ASSERT_EQ(walk.walk(20.0, nobody), Advice::kLeadOn);
    walk.arrived = false;
  }
  ASSERT_EQ(walk.walk(20.0, nobody), Advice::kWait);
  EXPECT_EQ(walk.walk(20.0, nobody), Advice::kGiveUp);
}

TEST(GuideWatch, LooksWhetherHeHasArrivedToo) {
  Walk walk;
  walk.walk(10.0, [](double) { return 1.0; });
  walk.walk(3.0, [](double) { return -1.0; });
  walk.arrived = true;
  EXPECT_EQ(walk.walk(1.0, [](double) { return -1.0; }), Advice::kWait);
  EXPECT_EQ(walk.walk(20.0, [](double) { return -1.0; }), Advice::kGoBack);
  Walk other;
  other.walk(10.0, [](double) { return 1.0; });
  other.arrived = true;
  EXPECT_EQ(other.walk(1.0, [](double) { return -1.0; }), Advice::kNone) << "he was there a moment ago";
}

TEST(GuideWatch, LosesNobodyWhereItNeedNotDrive) {
  Walk walk;
  walk.arrived = true;
  EXPECT_EQ(walk.walk(0.2, [](double) { return -1.0; }), Advice::kNone);
  EXPECT_TRUE(walk.guide.leads());
}

TEST(GuideWatch, StopsBesideWhomItMeetsOnItsWayBack) {
  Walk walk;
  const auto nobody = [](double) { return -1.0; };
  walk.walk(10.0, [](double) { return 1.0; });
  ASSERT_EQ(walk.walk(20.0, nobody), Advice::kWait);
  ASSERT_EQ(walk.walk(20.0, nobody), Advice::kGoBack);
  EXPECT_EQ(walk.walk(1.0, [](double) { return 1.2; }), Advice::kWait);
  EXPECT_EQ(walk.walk(20.0, nobody), Advice::kLeadOn);
}

TEST(GuideWatch, CountsOnlyReturnsToOnePlace) {
  Walk walk;
  const auto nobody = [](double) { return -1.0; };
  for (int i = 0; i < 5; ++i) {
    walk.walk(8.0, [](double) { return 1.0; });
    ASSERT_EQ(walk.walk(20.0, nobody), Advice::kWait);
    ASSERT_EQ(walk.walk(20.0, nobody), Advice::kGoBack) << "he has come along since the last time";
    walk.arrived = true;
    ASSERT_EQ(walk.walk(20.0, nobody), Advice::kLeadOn);
    walk.arrived = false;
  }
}

TEST(GuideWatch, ObeysItsVisitor) {
  Walk walk;
  const auto follower = [](double) { return 1.0; };
  walk.guide.hear("wait");
  EXPECT_EQ(walk.walk(1.0, follower), Advice::kWait);
  EXPECT_EQ(walk.walk(300.0, follower), Advice::kNone) << "as long as he likes";
  walk.guide.hear("here");
  EXPECT_EQ(walk.walk(1.0, follower), Advice::kLeadOn);
}

}  // namespace
}  // namespace luminav
