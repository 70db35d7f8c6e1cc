#include "services/localizer/particle_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

FixtureSighting sighting_at(double x, double y, double theta) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = {x, y, theta};
  sighting.covariance.setZero();
  return sighting;
}

class ParticleFilterTest : public ::testing::Test {
 protected:
  testing::TestBuilding building_ = testing::two_rooms();
  FixtureMap map_{building_.building.fixtures};
  WallField walls_{building_.walls};
  ParticleParams params_{.count = 500};
  ParticleFilter filter_{map_, walls_, params_, 7};
};

TEST(SplitMix, AgreesWithThePublishedSequence) {
  SplitMix uniform(42);
  EXPECT_NEAR(uniform.uniform(), 0.741564878772, 1e-12);
}

TEST_F(ParticleFilterTest, EquationOneIsOneForAPerfectFit) {
  // fixture 1 stands at (1.5, 1.6), heading 0
  EXPECT_NEAR(filter_.score({1.5, 1.6, 0.0}, {sighting_at(0.0, 0.0, 0.0)}), 1.0, 1e-9);
  EXPECT_NEAR(filter_.score({1.5, 1.6, kPi}, {sighting_at(0.0, 0.0, 0.0)}), 1.0, 1e-9);
}

TEST_F(ParticleFilterTest, EquationOneIsHalvedAtItsDistanceAndItsAngle) {
  EXPECT_NEAR(filter_.score({1.65, 1.6, 0.0}, {sighting_at(0.0, 0.0, 0.0)}), 0.5, 1e-6);
  EXPECT_NEAR(filter_.score({1.5, 1.6, radians(10.0)}, {sighting_at(0.0, 0.0, 0.0)}), 0.5, 1e-6);
}

TEST_F(ParticleFilterTest, EquationOneIsTheMeanOverTheSightings) {
  const double one = filter_.score({1.5, 1.6, 0.0}, {sighting_at(0.0, 0.0, 0.0)});
  const double other = filter_.score({1.5, 1.6, 0.0}, {sighting_at(0.3, 0.0, 0.0)});
  EXPECT_NEAR(filter_.score({1.5, 1.6, 0.0}, {sighting_at(0.0, 0.0, 0.0), sighting_at(0.3, 0.0, 0.0)}),
              0.5 * (one + other), 1e-9);
}

TEST_F(ParticleFilterTest, AParticleInAWallCountsForTheLeast) {
  EXPECT_NEAR(filter_.score({0.05, 1.6, 0.0}, {sighting_at(1.45, 0.0, 0.0)}), params_.least_free, 1e-9);
}

TEST_F(ParticleFilterTest, ScattersInTheFreeSpaceAndStaysThere) {
  for (int i = 0; i < 20; ++i) {
    filter_.predict({0.2, 0.0, 0.1});
    filter_.update({sighting_at(0.5, 0.2, 0.0)});
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < filter_.size(); ++i) {
    EXPECT_TRUE(walls_.is_free(filter_.pose(i).position()));
    sum += filter_.weight(i);
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST_F(ParticleFilterTest, DoesNotUpdateWithoutSightings) {
  const double before = filter_.weight(3);
  filter_.update({});
  EXPECT_EQ(filter_.weight(3), before);
}

TEST_F(ParticleFilterTest, ClustersShareAllTheWeight) {
  filter_.gather({{4.0, 3.0, 3.1}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()}, 1.0);
  const auto clusters = find_clusters(filter_, map_.smallest_spacing(), ClusterParams{});
  double sum = 0.0;
  for (const PoseCluster& cluster : clusters) {
    sum += cluster.weight;
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
  EXPECT_GT(clusters.front().weight, 0.9);
  EXPECT_NEAR(clusters.front().belief.pose.x, 4.0, 0.03);
  EXPECT_NEAR(wrap_angle(clusters.front().belief.pose.theta - 3.1), 0.0, 0.03);
}

TEST_F(ParticleFilterTest, MotionNoiseHasTheStatedDeviation) {
  ParticleFilter free(map_, walls_, {.count = 4000, .turn_by_way = 0.0, .redraws = 0}, 3);
  free.gather({{4.0, 3.4, 0.0}, 1e-12 * Eigen::Matrix3d::Identity()}, 1.0);
  free.predict({1.0, 0.0, 0.0});
  double mean = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < free.size(); ++i) {
    mean += free.pose(i).x - 4.0;
    square += std::pow(free.pose(i).x - 5.0, 2);
  }
  EXPECT_NEAR(mean / 4000.0, 1.0, 0.01);
  EXPECT_NEAR(std::sqrt(square / 4000.0), 0.1, 0.005);
}

}  // namespace
}  // namespace luminav
