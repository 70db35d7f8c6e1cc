#include "services/localizer/paper/sighting_matcher.hpp"

#include <gtest/gtest.h>

#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

/// A corridor whose fixtures are looked at from below the first one.
class SightingMatcherTest : public ::testing::Test {
 protected:
  /// The fixture of that index as seen from the pose.
  [[nodiscard]] FixtureSighting sighting_of(int index) const {
    const Fixture& fixture = model_.fixtures[index];
    FixtureSighting sighting;
    sighting.robot_from_fixture = belief_.pose.inverse() * fixture.world_from_fixture;
    sighting.covariance *= 1e-6;
    sighting.length = fixture.length;
    sighting.width = fixture.width;
    return sighting;
  }

  testing::TestBuilding corridor_ = testing::symmetric_corridor(4, 3.0);
  ObservationModel model_{corridor_.building, corridor_.walls, {}, {}};
  SightingMatcher matcher_{model_, MatchLimits{}};
  PoseBelief belief_{
      {model_.fixtures[0].world_from_fixture.position().x(), model_.fixtures[0].world_from_fixture.position().y(), 0.0},
      1e-4 * Eigen::Matrix3d::Identity()};
};

TEST_F(SightingMatcherTest, ExplainsASightingByTheFixtureThatIsThere) {
  FixtureSighting sighting = sighting_of(0);
  EXPECT_EQ(matcher_.match(belief_, sighting, {}), 0);
  sighting.robot_from_fixture.x += 1.0;
  EXPECT_EQ(matcher_.match(belief_, sighting, {}), -1);
}

TEST_F(SightingMatcherTest, TrustsNoAngleThatWasNotMeasured) {
  FixtureSighting sighting = sighting_of(0);
  EXPECT_LT(matcher_.noise_of(sighting, model_.fixtures[0], {})(2, 2), 1.0);
  sighting.has_theta = false;
  EXPECT_GT(matcher_.noise_of(sighting, model_.fixtures[0], {})(2, 2), 1e3);
}

TEST_F(SightingMatcherTest, CountsWhatFitsWhatDoesNotAndWhatIsMissing) {
  FixtureSighting odd = sighting_of(0);
  odd.robot_from_fixture.x += 1.0;
  const ViewEvidence both = matcher_.compare(belief_, {{0, {sighting_of(0), odd}}, {}});
  EXPECT_EQ(both.fits, 1);
  EXPECT_EQ(both.misfits, 1);
  EXPECT_EQ(both.absent, 0);
  EXPECT_FALSE(both.is_in_wall);
  EXPECT_EQ(matcher_.compare(belief_, {{}, {}}).absent, 1) << "it hangs right above";
}

}  // namespace
}  // namespace luminav
