#include "services/surveyor/survey/fixture_judgement.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "services/common/ceiling/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr double kMargin = 0.10;        // [m] to the border of the view, within which a fixture ought to be seen
constexpr double kMinSeenShare = 0.25;  // of the images that ought to have shown it
constexpr int kMinSeen = 4;             // images
constexpr double kMaxOverlap = 0.5;     // share of the shorter side by which two fixtures may not overlap

std::set<int> frames_of(const SurveyedFixture& fixture, const std::vector<FixturePass>& passes) {
  std::set<int> frames;
  for (const int pass : fixture.passes) {
    for (const PassSighting& seen : passes[static_cast<std::size_t>(pass)].sightings) {
      frames.insert(seen.frame);
    }
  }
  return frames;
}

bool has_burned(const SurveyedFixture& fixture, const std::vector<FixturePass>& passes) {
  return std::any_of(fixture.passes.begin(), fixture.passes.end(), [&](int pass) {
    const std::vector<PassSighting>& sightings = passes[static_cast<std::size_t>(pass)].sightings;
    return std::any_of(sightings.begin(), sightings.end(), [](const PassSighting& seen) {
      return seen.sighting.state == SightingState::kLit || seen.sighting.state == SightingState::kHalf;
    });
  });
}

/// Whether two rectangles on the ceiling overlap by more than a share of their shorter sides, on the axes of both.
bool overlap(const Fixture& a, const Pose2& world_from_a, const Fixture& b, const Pose2& world_from_b, double share) {
  const Eigen::Vector2d between = world_from_b.position() - world_from_a.position();
  const auto half_extent = [](const Fixture& fixture, const Pose2& pose, const Eigen::Vector2d& axis) {
    const Eigen::Vector2d along(std::cos(pose.theta), std::sin(pose.theta));
    const Eigen::Vector2d across(-along.y(), along.x());
    return 0.5 * (fixture.length * std::abs(along.dot(axis)) + fixture.width * std::abs(across.dot(axis)));
  };
  const double allowed = share * std::min(a.width, b.width);
  for (const double theta :
       {world_from_a.theta, world_from_a.theta + 0.5 * kPi, world_from_b.theta, world_from_b.theta + 0.5 * kPi}) {
    const Eigen::Vector2d axis(std::cos(theta), std::sin(theta));
    const double room = half_extent(a, world_from_a, axis) + half_extent(b, world_from_b, axis);
    if (std::abs(between.dot(axis)) > room - allowed) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<JudgedFixture> judge_fixtures(const SurveyEstimate& estimate, const std::vector<KeyFrame>& frames,
                                          const std::vector<FixturePass>& passes, const SurveyModel& model) {
  const CeilingView view(model.robot.camera);
  const auto kind_of = [&](std::size_t f) -> const Fixture& {
    return model.kinds.kinds[static_cast<std::size_t>(estimate.fixtures[f].kind)];
  };
  std::vector<JudgedFixture> judged(estimate.fixtures.size());
  std::vector<std::size_t> order(judged.size());
  for (std::size_t f = 0; f < judged.size(); ++f) {
    const SurveyedFixture& fixture = estimate.fixtures[f];
    const std::set<int> seen_in = frames_of(fixture, passes);
    judged[f].seen = static_cast<int>(seen_in.size());
    judged[f].has_burned = has_burned(fixture, passes);
    int seen_whole = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Pose2 robot_from_fixture = estimate.poses[i].inverse() * fixture.world_from_fixture;
      if (view.is_wholly_visible(robot_from_fixture, kind_of(f), kMargin)) {
        ++judged[f].expected;
        seen_whole += seen_in.count(static_cast<int>(i)) > 0 ? 1 : 0;
      }
    }
    if (fixture.known >= 0) {
      continue;  // a lamp that is dark today hangs there all the same
    }
    if (judged[f].seen < kMinSeen || seen_whole < kMinSeenShare * judged[f].expected) {
      judged[f].judgement = Judgement::kSeldomSeen;
    }
  }
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(estimate.fixtures[a].known >= 0, judged[a].seen) >
           std::pair(estimate.fixtures[b].known >= 0, judged[b].seen);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_known = estimate.fixtures[order[i]].known >= 0;
    for (std::size_t k = 0; k < i && !is_known && judged[order[i]].judgement == Judgement::kFixture; ++k) {
      if (judged[order[k]].judgement == Judgement::kFixture &&
          overlap(kind_of(order[i]), estimate.fixtures[order[i]].world_from_fixture, kind_of(order[k]),
                  estimate.fixtures[order[k]].world_from_fixture, kMaxOverlap)) {
        judged[order[i]].judgement = Judgement::kOverlaps;
      }
    }
  }
  return judged;
}

void add_uncertainty(std::vector<JudgedFixture>& judged, const SurveyEstimate& estimate,
                     const Eigen::MatrixXd& covariance) {
  const auto count = static_cast<Eigen::Index>(judged.size());
  if (count == 0) {
    return;
  }
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    middle += fixture.world_from_fixture.position() / static_cast<double>(count);
  }
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(3 * count, 3);
  for (Eigen::Index f = 0; f < count; ++f) {
    const Eigen::Vector2d from_middle =
        estimate.fixtures[static_cast<std::size_t>(f)].world_from_fixture.position() - middle;
    rigid.block<3, 3>(3 * f, 0) << 1.0, 0.0, -from_middle.y(),  //
        0.0, 1.0, from_middle.x(),                              //
        0.0, 0.0, 1.0;
  }
  Eigen::MatrixXd places = rigid;  // the motion is told from the places alone
  for (Eigen::Index f = 0; f < count; ++f) {
    places.row(3 * f + 2).setZero();
  }
  Eigen::Matrix3d square = places.transpose() * places;
  square(2, 2) += 1e-9;  // of a single fixture
  const Eigen::MatrixXd told = square.ldlt().solve(places.transpose());
  const Eigen::MatrixXd left = covariance - rigid * (told * covariance);
  for (Eigen::Index f = 0; f < count; ++f) {
    // the rows and columns of this fixture in (1 - rigid told) covariance (1 - rigid told)'
    const Eigen::MatrixXd row = left.middleRows(3 * f, 3);
    const Eigen::Matrix3d own =
        row.middleCols(3 * f, 3) - (row * told.transpose()) * rigid.middleRows(3 * f, 3).transpose();
    JudgedFixture& fixture = judged[static_cast<std::size_t>(f)];
    fixture.covariance = 0.5 * (own + own.transpose());
    const Eigen::Matrix2d position = fixture.covariance.topLeftCorner<2, 2>();
    const Eigen::Vector2d variances = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position).eigenvalues();
    fixture.sigma_across = std::sqrt(std::max(0.0, variances(0)));
    fixture.sigma_along = std::sqrt(std::max(0.0, variances(1)));
    fixture.sigma_heading = std::sqrt(std::max(0.0, fixture.covariance(2, 2)));
  }
}

}  // namespace luminav
