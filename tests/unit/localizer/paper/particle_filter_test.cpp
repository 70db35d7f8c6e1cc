#include "services/localizer/paper/particle_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "services/localizer/paper/pose_clusters.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

FixtureSighting sighting_at(double x, double y, double theta) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = {x, y, theta};
  sighting.covariance.setZero();
  return sighting;
}

constexpr double kFloatSum = 1e-6;  // weights are stored as float

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

TEST_F(ParticleFilterTest, GivesEachAliasOfTheFirstViewAsMuchWeight) {
  params_.count = 5000;
  ParticleFilter filter(map_, walls_, params_, 7);
  const FixtureSighting sighting = sighting_at(0.3, 0.0, 0.0);
  filter.update({sighting});
  double min = 1.0;
  double max = 0.0;
  for (const Fixture& fixture : map_.fixtures()) {
    for (const double turn : {0.0, kPi}) {
      const Pose2 alias = fixture.world_from_fixture * Pose2{0.0, 0.0, turn} * sighting.robot_from_fixture.inverse();
      double weight = 0.0;
      for (std::size_t i = 0; i < filter.size(); ++i) {
        const Pose2 pose = filter.pose(i);
        const bool is_near = distance(pose, alias) < 0.4 && std::abs(wrap_angle(pose.theta - alias.theta)) < 0.5;
        weight += is_near ? filter.weight(i) : 0.0;
      }
      min = std::min(min, weight);
      max = std::max(max, weight);
    }
  }
  EXPECT_GT(min, 0.7 * max);
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
  EXPECT_NEAR(filter_.score({0.05, 1.6, 0.0}, {sighting_at(1.45, 0.0, 0.0)}), params_.min_free, kFloatSum);
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
  EXPECT_NEAR(sum, 1.0, kFloatSum);
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
  EXPECT_NEAR(sum, 1.0, kFloatSum);
  EXPECT_GT(clusters.front().weight, 0.9);
  EXPECT_NEAR(clusters.front().belief.pose.x, 4.0, 0.03);
  EXPECT_NEAR(wrap_angle(clusters.front().belief.pose.theta - 3.1), 0.0, 0.03);
}

TEST_F(ParticleFilterTest, HasAsManyParticlesAsTheFreeFloorAsksFor) {
  const auto free = std::count(walls_.map().cells.begin(), walls_.map().cells.end(), Prior::kFree);
  const ParticleFilter filter(map_, walls_, {.count = 0, .density = 50.0}, 1);
  EXPECT_NEAR(static_cast<double>(filter.size()), 50.0 * 0.01 * static_cast<double>(free), 1.0);
}

/// Weight of the particles at (4, 3.4) beside that of all, after updates with a sighting that fits better at
/// (1.5, 1.6).
double share_of_the_misfit(ParticleFilter& filter, int updates) {
  filter.gather({{4.0, 3.4, 0.0}, 1e-12 * Eigen::Matrix3d::Identity()}, 1.0);
  filter.gather({{1.5, 1.6, 0.0}, 1e-12 * Eigen::Matrix3d::Identity()}, 0.5);
  for (int i = 0; i < updates; ++i) {
    filter.update({sighting_at(0.0, 0.0, 0.0)});
  }
  double share = 0.0;
  for (std::size_t i = 0; i < filter.size(); ++i) {
    share += distance(filter.pose(i), {4.0, 3.4, 0.0}) < 0.1 ? filter.weight(i) : 0.0;
  }
  return share;
}

TEST_F(ParticleFilterTest, CarriesItsWeightsFromUpdateToUpdate) {
  const ParticleParams params{.count = 1000, .weight_jitter = 0.0, .copied_share = 0.0, .random_share = 0.0};
  ParticleFilter once(map_, walls_, params, 7);
  ParticleFilter twice(map_, walls_, params, 7);
  const double first = share_of_the_misfit(once, 1);
  const double second = share_of_the_misfit(twice, 2);
  EXPECT_NEAR(second / (1.0 - second), std::pow(first / (1.0 - first), 2), 1e-3);
}

TEST_F(ParticleFilterTest, ACopyAndItsOriginalShareTheWeight) {
  const ParticleParams params{.count = 1000, .weight_jitter = 0.0, .copied_share = 0.1, .random_share = 0.0};
  ParticleParams without = params;
  without.copied_share = 0.0;
  ParticleFilter copying(map_, walls_, params, 7);
  ParticleFilter plain(map_, walls_, without, 7);
  // the worst tenth, which the copies replace, weighs next to nothing after one update
  EXPECT_NEAR(share_of_the_misfit(copying, 1), share_of_the_misfit(plain, 1), 0.05);
}

TEST_F(ParticleFilterTest, MotionNoiseHasTheStatedDeviation) {
  ParticleFilter free(map_, walls_, {.count = 4000, .noise = {.turn_by_distance = 0.0}, .redraws = 0}, 3);
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

ParticleParams systematic(int count) {
  ParticleParams params;
  params.count = count;
  params.scoring = ParticleScoring::kGaussian;
  params.resampling = ParticleResampling::kSystematic;
  params.random_share = 0.0;
  return params;
}

TEST_F(ParticleFilterTest, GaussianScoringIsTheProductOverTheSightings) {
  const ParticleFilter gaussian(map_, walls_, systematic(8), 1);
  // fixture 1 stands at (1.5, 1.6): one sighting fits, the other is one deviation away
  const double expected = (1.0 + 1e-4) * (std::exp(-0.5) + 1e-4);
  EXPECT_NEAR(gaussian.score({1.5, 1.6, 0.0}, {sighting_at(0.0, 0.0, 0.0), sighting_at(0.1, 0.0, 0.0)}), expected,
              1e-4);
  EXPECT_NEAR(gaussian.score({1.5, 1.6, radians(3.0)}, {sighting_at(0.0, 0.0, 0.0)}), std::exp(-0.5), 1e-3);
}

TEST_F(ParticleFilterTest, SystematicResamplingCopiesInProportionToTheScore) {
  ParticleFilter filter(map_, walls_, systematic(1000), 11);
  filter.gather({{1.5, 1.6, 0.0}, Eigen::Vector3d(0.0225, 0.0225, 1e-12).asDiagonal()}, 1.0);
  filter.update({sighting_at(0.0, 0.0, 0.0)});
  // prior of 0.15 m and likelihood of 0.1 m: the posterior's deviation is 0.0832 m
  double square = 0.0;
  for (std::size_t i = 0; i < filter.size(); ++i) {
    square += std::pow(filter.pose(i).x - 1.5, 2);
  }
  EXPECT_NEAR(std::sqrt(square / 1000.0), 0.0832, 0.005);
}

TEST_F(ParticleFilterTest, OneParticleThatFitsTakesAllPlaces) {
  ParticleFilter filter(map_, walls_, systematic(1003), 11);
  filter.gather({{20.0, 20.0, 0.0}, 1e-12 * Eigen::Matrix3d::Identity()}, 1.0);
  filter.gather({{1.5, 1.6, 0.0}, 1e-12 * Eigen::Matrix3d::Identity()}, 1.5 / 1003.0);
  filter.update({sighting_at(0.0, 0.0, 0.0), sighting_at(0.0, 0.0, 0.0), sighting_at(0.0, 0.0, 0.0)});
  for (std::size_t i = 0; i < filter.size(); ++i) {
    ASSERT_NEAR(filter.pose(i).x, 1.5, 1e-4) << i;
  }
}

TEST_F(ParticleFilterTest, TheSameSeedGivesTheSameBytesOnEveryMachine) {
  std::uint64_t sum = 0xcbf29ce484222325ULL;  // FNV-1a
  for (int step = 0; step < 20; ++step) {
    filter_.predict({0.1, 0.01, 0.2});
    filter_.update({sighting_at(0.5, -0.3, 0.2), sighting_at(-0.4, 0.8, 1.0)});
    for (std::size_t i = 0; i < filter_.size(); ++i) {
      for (const double value : {filter_.pose(i).x, filter_.pose(i).y, filter_.pose(i).theta, filter_.weight(i)}) {
        sum = (sum ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3ULL;
      }
    }
  }
  // seen on x86-64, with the standard library's functions for processors with fused multiplication and for those
  // without
  EXPECT_EQ(sum, 16604078456126519333ULL);
}

TEST_F(ParticleFilterTest, NeedsNoMoreThan64BytesAParticle) {
  EXPECT_LE(ParticleFilter(map_, walls_, systematic(1000), 1).memory_bytes(), 64000U);
  EXPECT_LE(ParticleFilter(map_, walls_, {.count = 1000}, 1).memory_bytes(), 64000U);
}

}  // namespace
}  // namespace luminav
