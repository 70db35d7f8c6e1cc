#include "services/surveyor/parts/carry_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

const std::vector<Fixture> kCeiling = {fixture_at(1, 2.0, 0.0, 0.5 * kPi), fixture_at(2, 5.0, 0.0, 0.5 * kPi),
                                       fixture_at(3, 8.0, 0.0, 0.5 * kPi)};

/// Key frames of a drive along x that ends, or is carried elsewhere, at a place.
std::vector<KeyFrame> frames_of(double from, double to, double y = 0.0) {
  const SurveyModel model = synthetic_model();
  return choose_key_frames(drive_along({{from, y}, {to, y}}, kCeiling, model, {}).drive, model.robot.camera, 2.8);
}

std::vector<int> carries_in(const std::vector<KeyFrame>& frames) {
  const SurveyModel model = synthetic_model();
  return find_carries(frames, find_passes(frames, model.kinds), model);
}

TEST(CarrySearch, FindsNoneInADriveOfItsOwnWheels) {
  EXPECT_THAT(carries_in(frames_of(0.0, 10.0)), testing::IsEmpty());
}

TEST(CarrySearch, FindsWhereAFixtureVanishesAndAnotherAppears) {
  std::vector<KeyFrame> frames = frames_of(0.0, 2.0);  // below the first fixture
  const std::size_t before = frames.size();
  const Pose2 end = frames.back().odom_from_robot;
  for (KeyFrame frame : frames_of(7.8, 10.0, 0.3)) {  // carried to shortly before the third
    frame.odom_from_robot = end * Pose2{0.1, 0.0, 0.0} * frame.odom_from_robot;
    frame.travelled += 2.1;
    frame.steps = {{0.1, 0.0, 0.0}};
    frames.push_back(frame);
  }
  const std::vector<int> carries = carries_in(frames);
  ASSERT_EQ(carries.size(), 1u);
  EXPECT_EQ(carries[0], static_cast<int>(before));
  split_at(frames, carries);
  EXPECT_EQ(frames[before - 1].part, 0);
  EXPECT_EQ(frames[before].part, 1);
  EXPECT_TRUE(frames[before].steps.empty());
  EXPECT_EQ(frames.back().part, 1);
}

/// A robot that stands for five looks and sees a fixture at one place, then at another.
SurveyDrive standing(const Pose2& first, const Pose2& last, std::int64_t period = 400'000) {
  SurveyDrive drive;
  for (int i = 0; i < 12; ++i) {
    drive.odometry.push_back({1'000'000 + period * i, 1, {i < 10 ? 0.0 : 0.1, 0.0, 0.0}, 0.0, 0.0});
  }
  for (int i = 0; i < 5; ++i) {
    FixtureSighting sighting;
    sighting.robot_from_fixture = i < 3 ? first : last;
    drive.frames.push_back({1'010'000 + period * i, {sighting}});
  }
  return drive;
}

TEST(CarrySearch, FindsThatItWasLiftedWhereItStood) {
  EXPECT_THAT(find_lifts(standing({0.2, 0.0, 0.0}, {0.21, 0.0, 0.01})), testing::IsEmpty());
  EXPECT_THAT(find_lifts(standing({0.2, 0.0, 0.0}, {0.2, 0.0, kPi})), testing::IsEmpty());  // half a turn is none
  EXPECT_EQ(find_lifts(standing({0.2, 0.0, 0.0}, {-0.3, 0.2, 0.0})).size(), 1u);
  EXPECT_EQ(find_lifts(standing({0.2, 0.0, 0.0}, {0.2, 0.0, 1.0})).size(), 1u);
}

TEST(CarrySearch, TakesNoTurnForALift) {
  const std::int64_t short_while = 50'000;  // [us] between two readings of the wheels
  EXPECT_THAT(find_lifts(standing({0.2, 0.0, 0.0}, {-0.3, 0.2, 0.0}, short_while)), testing::IsEmpty());
  SurveyDrive drive = standing({0.2, 0.0, 0.0}, {-0.8, 0.2, 0.0});
  for (SightingFrame& frame : drive.frames) {  // both are in view all the time, now one is whole and now the other
    FixtureSighting other = frame.sightings.front();
    other.robot_from_fixture.x = other.robot_from_fixture.x > 0.0 ? -0.8 : 0.2;
    other.robot_from_fixture.y = 0.2 - other.robot_from_fixture.y;
    other.clipped = true;
    frame.sightings.push_back(other);
  }
  EXPECT_THAT(find_lifts(drive), testing::IsEmpty());
}

TEST(CarrySearch, IsNotMisledByAFixtureThatIsSeenBesideItsPlace) {
  std::vector<KeyFrame> frames = frames_of(0.0, 10.0);
  for (KeyFrame& frame : frames) {
    for (FixtureSighting& sighting : frame.sightings) {
      sighting.robot_from_fixture.x += frame.odom_from_robot.x > 5.0 ? 0.2 : 0.0;
    }
  }
  const SurveyModel model = synthetic_model();
  EXPECT_EQ(find_passes(frames, model.kinds).size(), kCeiling.size() + 1);  // the second fixture is lost, and found
  EXPECT_THAT(carries_in(frames), testing::IsEmpty());
}

TEST(CarrySearch, IsNotMisledByALampThatGoesOut) {
  std::vector<KeyFrame> frames = frames_of(0.0, 10.0);
  for (KeyFrame& frame : frames) {
    if (frame.odom_from_robot.x > 2.0 && frame.odom_from_robot.x < 3.5) {
      frame.sightings.clear();
    }
  }
  EXPECT_THAT(carries_in(frames), testing::IsEmpty());
}

}  // namespace
}  // namespace luminav
