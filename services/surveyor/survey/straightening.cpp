#include "services/surveyor/survey/straightening.hpp"

#include <Eigen/Geometry>
#include <complex>

namespace luminav {
namespace {

struct Extent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);

  void include(const Pose2& pose) {
    low = low.cwiseMin(pose.position());
    high = high.cwiseMax(pose.position());
  }
};

Extent extent_of(const SurveyEstimate& estimate) {
  Extent extent;
  for (const Pose2& pose : estimate.poses) {
    extent.include(pose);
  }
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    extent.include(fixture.world_from_fixture);
  }
  return extent;
}

}  // namespace

double dominant_direction(const SurveyEstimate& estimate, const CeilingKinds& kinds) {
  std::complex<double> sum = 0.0;
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    if (kinds.kinds[static_cast<std::size_t>(fixture.kind)].shape != FixtureShape::kRound) {
      sum += std::polar(1.0, 4.0 * fixture.world_from_fixture.theta);
    }
  }
  return 0.25 * std::arg(sum);
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, double angle) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(angle).toRotationMatrix();
  return rotation * covariance * rotation.transpose();
}

void transform(SurveyEstimate& estimate, const Pose2& new_from_old) {
  for (Pose2& pose : estimate.poses) {
    pose = new_from_old * pose;
  }
  for (std::vector<SurveyedFixture>* fixtures : {&estimate.fixtures, &estimate.dropped}) {
    for (SurveyedFixture& fixture : *fixtures) {
      fixture.world_from_fixture = new_from_old * fixture.world_from_fixture;
    }
  }
  estimate.direction = wrap_modulo(estimate.direction + new_from_old.theta, 0.5 * kPi);
}

void straighten(SurveyEstimate& estimate, double direction) {
  transform(estimate, {0.0, 0.0, -direction});
  const Extent lying = extent_of(estimate);
  const Eigen::Vector2d size = lying.high - lying.low;
  if (size.y() > size.x()) {
    transform(estimate, {0.0, 0.0, 0.5 * kPi});
  }
  const Extent turned = extent_of(estimate);
  transform(estimate, {-turned.low.x(), -turned.low.y(), 0.0});
}

}  // namespace luminav
