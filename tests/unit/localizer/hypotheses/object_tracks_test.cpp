#include "services/localizer/hypotheses/object_tracks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace luminav {
namespace {

/// Tracks after a robot that stood still saw these places [m, robot], one in each image.
std::vector<ObjectTrack> seen_in_turn(const std::vector<Eigen::Vector2d>& places) {
  ObjectTracks tracks;
  for (const Eigen::Vector2d& place : places) {
    SightingFrame frame{0, std::vector<FixtureSighting>(1)};
    frame.sightings[0].robot_from_fixture = {place.x(), place.y(), 0.0};
    frame.sightings[0].covariance = 1e-4 * Eigen::Matrix3d::Identity();
    tracks.update(frame, {}, 0.0);
  }
  return tracks.objects();
}

TEST(ObjectTracks, AreOneObjectWhereTheSameIsSeenAgain) {
  const std::vector<ObjectTrack> tracks = seen_in_turn({{0.0, 0.0}, {0.05, 0.0}, {2.4, 0.0}});
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].frames, 2);
  EXPECT_EQ(tracks[1].frames, 1);
}

TEST(ObjectTracks, TellWhichObjectExtendsARow) {
  const auto extends_row = [](const std::vector<Eigen::Vector2d>& places) {
    return seen_in_turn(places).back().extends_row;
  };
  EXPECT_TRUE(extends_row({{0.0, 0.0}, {2.4, 0.0}, {4.8, 0.1}}));
  EXPECT_TRUE(extends_row({{0.0, 0.0}, {9.0, 9.0}, {0.0, 3.0}, {0.0, 6.0}})) << "whatever hangs beside it";
  EXPECT_FALSE(extends_row({{0.0, 0.0}, {2.4, 0.0}})) << "two are no row";
  EXPECT_FALSE(extends_row({{0.0, 0.0}, {2.4, 0.0}, {5.6, 0.0}})) << "another pitch";
  EXPECT_FALSE(extends_row({{0.0, 0.0}, {2.4, 0.0}, {2.4, 2.4}})) << "round a corner";
  EXPECT_FALSE(extends_row({{0.0, 0.0}, {4.8, 0.0}, {2.4, 0.0}})) << "between two";
}

TEST(ObjectTracks, KeepALampInItsRowWhenTheOthersAreForgotten) {
  ObjectTracks tracks;
  for (double x = 0.0; x < 9.0; x += 0.1) {
    SightingFrame frame;
    for (const double lamp : {0.0, 2.4, 4.8}) {
      if (std::abs(lamp - x) < 0.5 || (lamp == 4.8 && x > lamp)) {
        frame.sightings.emplace_back().robot_from_fixture = {lamp - x, 0.0, 0.0};
        frame.sightings.back().covariance = 1e-4 * Eigen::Matrix3d::Identity();
      }
    }
    tracks.update(frame, {x, 0.0, 0.0}, x);
  }
  ASSERT_EQ(tracks.objects().size(), 1U);
  EXPECT_TRUE(tracks.objects()[0].extends_row);
}

}  // namespace
}  // namespace luminav
