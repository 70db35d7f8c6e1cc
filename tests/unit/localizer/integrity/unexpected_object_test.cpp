#include "services/localizer/integrity/unexpected_object.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace luminav {
namespace {

const Pose2 kFixture{0.9, -0.2, 0.4};  // [robot frame] where the pose has one
const Pose2 kThing{-0.7, -0.8, 1.2};   // where it has none

/// A robot that stands under a fixture that fits, and sees other things come.
class Watcher {
 public:
  /// So many images show these things beside the fixture, before each of which the wheels turn by `wheels`. Returns how
  /// often one of the things was told.
  int see(const std::vector<Pose2>& things, int images, const Pose2& wheels = {}, bool fit = false) {
    int told = 0;
    for (int i = 0; i < images; ++i) {
      odom_ = odom_ * wheels;
      SightingFrame frame;
      std::vector<FixtureMatch> matches;
      frame.utime = utime_ += 66'667;
      const auto show = [&](const Pose2& thing, bool fits) {
        if (fits) {
          matches.push_back({frame.sightings.size(), static_cast<int>(frame.sightings.size()), 0.0});
        }
        frame.sightings.emplace_back().robot_from_fixture = thing;
      };
      show(kFixture, true);
      for (const Pose2& thing : things) {
        show(thing, fit);
      }
      const auto newcomer = watch_.look(frame, matches, odom_);
      told += newcomer ? 1 : 0;
      if (newcomer) {
        EXPECT_EQ(*newcomer, things.front().position());
      }
    }
    return told;
  }
  UnexpectedObject& watch() { return watch_; }

 private:
  UnexpectedObject watch_{TrackingRules{}};
  Pose2 odom_;
  std::int64_t utime_ = 1'000'000'000;
};

TEST(UnexpectedObject, TellsOnceWhatComesIntoViewOfAStandingRobotAndFitsNothing) {
  Watcher watcher;
  EXPECT_EQ(watcher.see({}, 10), 0);
  EXPECT_EQ(watcher.see({kThing}, 6), 0);
  EXPECT_EQ(watcher.see({kThing}, 30), 1);
}

TEST(UnexpectedObject, IsCalmUnderFalseAlarmsHoweverLongTheRobotStands) {
  Watcher watcher;
  int told = watcher.see({}, 10);
  for (int minute = 0; minute < 60; ++minute) {
    told += watcher.see({kThing}, 3);
    told += watcher.see({}, 900);
  }
  EXPECT_EQ(told, 0);
}

TEST(UnexpectedObject, TellsWhatTheDetectorMissesInEverySecondImage) {
  Watcher watcher;
  int told = watcher.see({}, 10);
  for (int i = 0; i < 10; ++i) {
    told += watcher.see({kThing}, 1);
    told += watcher.see({}, 1);
  }
  EXPECT_EQ(told, 1);
}

TEST(UnexpectedObject, TellsWhatIsSeenWhereAThingOfAnotherHeadingWas) {
  Watcher watcher;
  EXPECT_EQ(watcher.see({{kThing.x + 0.3, kThing.y, kThing.theta - 1.5}}, 10), 0);
  EXPECT_EQ(watcher.see({kThing}, 10), 1);
}

TEST(UnexpectedObject, IsCalmUnderWhatWasInViewWhenTheRobotCameToStand) {
  Watcher watcher;
  EXPECT_EQ(watcher.see({kThing}, 1), 0);
  EXPECT_EQ(watcher.see({}, 10), 0);
  EXPECT_EQ(watcher.see({kThing}, 20), 0);
  // half a turn is all the same, and the centre of what the border cuts may be found elsewhere
  EXPECT_EQ(watcher.see({{kThing.x + 0.3, kThing.y + 0.3, kThing.theta + kPi}}, 20), 0);
}

TEST(UnexpectedObject, IsCalmUnderWhatTheWheelsBringIntoView) {
  for (const Pose2 wheels : {Pose2{0.01, 0.0, 0.0}, {0.0, 0.0, radians(0.6)}}) {
    Watcher watcher;
    EXPECT_EQ(watcher.see({}, 10, wheels), 0);
    EXPECT_EQ(watcher.see({kThing}, 3, wheels), 0);
    EXPECT_EQ(watcher.see({kThing}, 10), 0);
  }
}

TEST(UnexpectedObject, IsCalmUnderALampThatIsSwitchedOn) {
  Watcher watcher;
  EXPECT_EQ(watcher.see({}, 10), 0);
  EXPECT_EQ(watcher.see({kThing}, 20, {}, true), 0);
}

TEST(UnexpectedObject, TakesWhatIsInViewWhenItBeginsForKnown) {
  Watcher watcher;
  EXPECT_EQ(watcher.see({kThing}, 20), 0);
  watcher.watch().clear();
  EXPECT_EQ(watcher.see({kThing}, 20), 0);
}

}  // namespace
}  // namespace luminav
