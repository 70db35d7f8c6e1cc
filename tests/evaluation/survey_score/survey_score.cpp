#include "tests/evaluation/survey_score/survey_score.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/common/ceiling/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr double kSame = 0.6;     // [m] between a surveyed fixture and the true one that it is
constexpr double kAlike = 0.05;   // [m] by which an element's sides may differ from those of a fixture like it
constexpr double kMinLook = 0.6;  // [m] of driving with all of a fixture in view
constexpr double kMargin = 0.10;  // [m] to the border of the view
constexpr int kRounds = 5;        // of matching and fitting

/// The nearest true fixture to each surveyed one; -1 = none near.
std::vector<int> match(const std::vector<ScoredFixture>& surveyed, const std::vector<Fixture>& truth,
                       const Pose2& truth_from_survey) {
  std::vector<int> matches;
  for (const ScoredFixture& scored : surveyed) {
    const Pose2 at = truth_from_survey * scored.fixture.world_from_fixture;
    int nearest = -1;
    double least = kSame;
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double apart = distance(at, truth[t].world_from_fixture);
      if (apart < least && truth[t].shape == scored.fixture.shape) {
        least = apart;
        nearest = static_cast<int>(t);
      }
    }
    matches.push_back(nearest);
  }
  return matches;
}

/// Whether an element hangs there that looks like the surveyed fixture.
bool is_an_element(const ScoredFixture& scored, const std::vector<CeilingElement>& elements,
                   const Pose2& truth_from_survey) {
  const Pose2 at = truth_from_survey * scored.fixture.world_from_fixture;
  return std::any_of(elements.begin(), elements.end(), [&](const CeilingElement& element) {
    return distance(at, element.world_from_element) < kSame &&
           std::abs(element.length - scored.fixture.length) < kAlike &&
           std::abs(element.width - scored.fixture.width) < kAlike;
  });
}

struct Similarity {
  Pose2 rigid;
  double scale = 1.0;  // of the truth over the survey
};

Similarity fit(const std::vector<ScoredFixture>& surveyed, const std::vector<Fixture>& truth,
               const std::vector<int>& matches, const Pose2& before) {
  Eigen::Vector2d from_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_mean = Eigen::Vector2d::Zero();
  double count = 0.0;
  const auto each = [&](const auto& visit) {
    for (std::size_t s = 0; s < surveyed.size(); ++s) {
      if (matches[s] >= 0) {
        visit(surveyed[s].fixture.world_from_fixture.position(),
              truth[static_cast<std::size_t>(matches[s])].world_from_fixture.position());
      }
    }
  };
  each([&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    from_mean += from;
    to_mean += to;
    count += 1.0;
  });
  if (count < 2.0) {
    return {before, 1.0};
  }
  from_mean /= count;
  to_mean /= count;
  double c = 0.0;
  double s = 0.0;
  double squared = 0.0;
  each([&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d a = from - from_mean;
    const Eigen::Vector2d b = to - to_mean;
    c += a.dot(b);
    s += a.x() * b.y() - a.y() * b.x();
    squared += a.squaredNorm();
  });
  Similarity similarity;
  similarity.rigid.theta = std::atan2(s, c);
  const Eigen::Vector2d turned = Pose2{0.0, 0.0, similarity.rigid.theta} * from_mean;
  similarity.rigid.x = to_mean.x() - turned.x();
  similarity.rigid.y = to_mean.y() - turned.y();
  similarity.scale = std::hypot(c, s) / squared;
  return similarity;
}

std::vector<bool> driven_under(const WorldTruth& world, const std::vector<Pose2>& path) {
  const CeilingView view(world.robot.camera);
  std::vector<double> looks(world.building.fixtures.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (std::size_t t = 0; t < looks.size(); ++t) {
      const Fixture& fixture = world.building.fixtures[t];
      const Pose2 seen = path[i].inverse() * fixture.world_from_fixture;
      looks[t] += view.is_wholly_visible(seen, fixture, kMargin) ? distance(path[i - 1], path[i]) : 0.0;
    }
  }
  std::vector<bool> result;
  std::transform(looks.begin(), looks.end(), std::back_inserter(result), [](double look) { return look >= kMinLook; });
  return result;
}

}  // namespace

SurveyScore score_survey(const std::vector<ScoredFixture>& surveyed, const WorldTruth& world,
                         const std::vector<Pose2>& path, const Pose2& truth_from_survey) {
  const std::vector<Fixture>& truth = world.building.fixtures;
  SurveyScore score;
  Similarity similarity{truth_from_survey, 1.0};
  std::vector<int> matches;
  for (int round = 0; round < kRounds; ++round) {
    matches = match(surveyed, truth, similarity.rigid);
    similarity = fit(surveyed, truth, matches, similarity.rigid);
  }
  score.truth_from_survey = similarity.rigid;
  score.scale = 1.0 / similarity.scale - 1.0;
  std::vector<int> times(truth.size(), 0);
  double squared = 0.0;
  double squared_heading = 0.0;
  double count = 0.0;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(similarity.rigid.theta).toRotationMatrix();
  for (std::size_t s = 0; s < surveyed.size(); ++s) {
    if (matches[s] < 0) {
      ++(is_an_element(surveyed[s], world.building.elements, similarity.rigid) ? score.alike : score.invented);
      continue;
    }
    const Fixture& hangs = truth[static_cast<std::size_t>(matches[s])];
    score.doubled += times[static_cast<std::size_t>(matches[s])]++ > 0 ? 1 : 0;
    const Pose2 at = similarity.rigid * surveyed[s].fixture.world_from_fixture;
    const Eigen::Vector2d error = at.position() - hangs.world_from_fixture.position();
    const double askew = wrap_modulo(at.theta - hangs.world_from_fixture.theta, symmetry_period(hangs.shape));
    const Eigen::Matrix2d covariance = turn * surveyed[s].covariance.topLeftCorner<2, 2>() * turn.transpose();
    score.worst = std::max(score.worst, error.norm());
    squared += error.squaredNorm();
    squared_heading += askew * askew;
    if (covariance.determinant() > 0.0) {
      score.normalised_squared += 0.5 * error.dot(covariance.inverse() * error);
    }
    count += 1.0;
  }
  const std::vector<bool> under = driven_under(world, path);
  for (std::size_t t = 0; t < truth.size(); ++t) {
    score.driven_under += under[t] ? 1 : 0;
    score.found += under[t] && times[t] > 0 ? 1 : 0;
  }
  score.position_rms = std::sqrt(squared / std::max(1.0, count));
  score.heading_rms = std::sqrt(squared_heading / std::max(1.0, count));
  score.normalised_squared /= std::max(1.0, count);
  return score;
}

std::string to_text(const SurveyScore& score) {
  return fmt::format(
      "{} of {} fixtures found, {} doubled, {} vents, {} invented; {:.1f} cm and {:.2f} deg RMS, {:.1f} cm at worst; "
      "scale {:+.2f} %; normalised error squared {:.2f}",
      score.found, score.driven_under, score.doubled, score.alike, score.invented, 100.0 * score.position_rms,
      degrees(score.heading_rms), 100.0 * score.worst, 100.0 * score.scale, score.normalised_squared);
}

std::string to_json(const SurveyScore& score) {
  const nlohmann::json figures = {{"driven_under", score.driven_under},
                                  {"found", score.found},
                                  {"doubled", score.doubled},
                                  {"alike", score.alike},
                                  {"invented", score.invented},
                                  {"position_rms_m", score.position_rms},
                                  {"heading_rms_deg", degrees(score.heading_rms)},
                                  {"worst_m", score.worst},
                                  {"scale", score.scale},
                                  {"normalised_squared", score.normalised_squared}};
  return figures.dump(1) + "\n";
}

}  // namespace luminav
