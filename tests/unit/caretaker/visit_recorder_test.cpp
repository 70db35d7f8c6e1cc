#include "services/caretaker/visit_recorder.hpp"

#include <gmock/gmock.h>

#include "services/common/geometry/split_mix.hpp"

namespace luminav {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kStart = 1'000'000'000;  // [us]

/// A robot that drives along y = 0 below fixtures at y = 0 and sees each as it is told to hang.
class VisitRecorderTest : public testing::Test {
 protected:
  VisitRecorderTest() {
    camera_.mounting.z = 0.3;
    for (int i = 0; i < 3; ++i) {
      Fixture fixture;
      fixture.id = i + 1;
      fixture.world_from_fixture = {3.0 * i, 0.0, 0.0};
      file_.push_back(fixture);
    }
    truth_ = file_;
  }

  VisitRecorder::Result drive(double from, double to, bool is_sure = true) {
    VisitRecorder recorder(camera_, file_);
    const CeilingView view(camera_);
    constexpr double kStep = 0.05;  // [m] at 10 Hz
    std::int64_t utime = kStart;
    for (double x = from; x <= to; x += kStep, utime += 100'000) {
      const Pose2 robot{x, 0.0, 0.0};
      LookedAtFrame looked{{utime, {}}, 80.0};
      for (const Fixture& fixture : truth_) {
        const Pose2 robot_from_fixture = robot.inverse() * fixture.world_from_fixture;
        if (view.is_wholly_visible(robot_from_fixture, fixture, 0.0)) {
          FixtureSighting sighting;
          sighting.robot_from_fixture = robot_from_fixture;
          sighting.length = fixture.length;
          sighting.width = fixture.width;
          sighting.state = state_;
          looked.frame.sightings.push_back(sighting);
        }
      }
      recorder.add_frame(looked);  // before the pose of its time, as on the robot
      recorder.add_pose({{utime, 1, robot, 0.5, 0.0}, is_sure});
    }
    recorder.end_all();
    return recorder.take_ended();
  }

  CameraDescription camera_;
  std::vector<Fixture> file_;
  std::vector<Fixture> truth_;
  SightingState state_ = SightingState::kLit;
};

TEST_F(VisitRecorderTest, MakesOneVisitOfEachFixtureThatIsPassed) {
  const auto ended = drive(-2.0, 8.0);
  ASSERT_THAT(ended.fixtures, SizeIs(3));
  EXPECT_THAT(ended.strangers, IsEmpty());
  for (const auto& [fixture, visit] : ended.fixtures) {
    EXPECT_GE(visit.expected, 10);
    EXPECT_GE(visit.lit, visit.expected - 1);
    EXPECT_NEAR(visit.offset.x, 0.0, 0.02);
    EXPECT_NEAR(visit.grey, 80.0, 1e-9);
    EXPECT_EQ(was_burning(visit), true);
  }
}

TEST_F(VisitRecorderTest, SaysByHowMuchAFixtureHangsBesideItsPlace) {
  truth_[1].world_from_fixture.y += 0.3;
  const auto ended = drive(-2.0, 8.0);
  ASSERT_THAT(ended.fixtures, SizeIs(3));
  EXPECT_EQ(ended.fixtures[1].first, 1);
  EXPECT_NEAR(ended.fixtures[1].second.offset.y, 0.3, 0.02);
  EXPECT_NEAR(ended.fixtures[0].second.offset.y, 0.0, 0.02);
}

TEST_F(VisitRecorderTest, CountsWhatOughtToBeSeenAndIsNot) {
  truth_.erase(truth_.begin() + 2);
  const auto ended = drive(-2.0, 8.0);
  ASSERT_THAT(ended.fixtures, SizeIs(3));
  EXPECT_EQ(ended.fixtures[2].second.seen(), 0);
  EXPECT_GE(ended.fixtures[2].second.expected, 10);
}

TEST_F(VisitRecorderTest, KeepsWhatHangsWhereTheFileHasNothing) {
  Fixture fixture;
  fixture.world_from_fixture = {1.5, 0.5, 0.7};
  truth_.push_back(fixture);
  const auto ended = drive(-2.0, 8.0);
  ASSERT_THAT(ended.strangers, SizeIs(1));
  EXPECT_NEAR(ended.strangers[0].world_from_fixture.x, 1.5, 0.02);
  EXPECT_NEAR(ended.strangers[0].world_from_fixture.theta, 0.7, 0.01);
  EXPECT_NEAR(ended.strangers[0].length, 1.2, 0.01);
}

TEST_F(VisitRecorderTest, SaysNothingWhileThePoseIsNotSure) {
  const auto ended = drive(-2.0, 8.0, false);
  EXPECT_THAT(ended.fixtures, IsEmpty());
  EXPECT_THAT(ended.strangers, IsEmpty());
}

TEST_F(VisitRecorderTest, TellsDarkFromBurning) {
  state_ = SightingState::kUnlit;
  const auto ended = drive(-2.0, 2.0);
  ASSERT_FALSE(ended.fixtures.empty());
  EXPECT_EQ(was_burning(ended.fixtures[0].second), false);
  EXPECT_GT(ended.fixtures[0].second.unlit, 0);
}

}  // namespace
}  // namespace luminav
