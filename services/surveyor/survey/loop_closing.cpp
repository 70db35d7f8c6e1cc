#include "services/surveyor/survey/loop_closing.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace luminav {
namespace {

constexpr double kGate = 16.3;                  // chi2(3) at 99.9 %: farther apart two fixtures are two
constexpr double kOtherGate = 30.0;             // of the next best one, which has to be out of it
constexpr double kPositionFloor = 0.03;         // [m] 1-sigma that two passes may differ by beyond the estimate's own
constexpr double kHeadingFloor = radians(1.0);  // [rad] likewise
constexpr double kMaxShare = 0.25;       // 1-sigma of what a closure spans, over the spacing of the fixtures there
constexpr double kSureSigma = 0.10;      // [m] below it a closure needs no other one that agrees
constexpr double kNeighbourhood = 10.0;  // [m] of the drive, in which others have to agree
constexpr double kAgreement = 0.30;      // [m] between what two closures shift by
constexpr double kMinSpacing = 0.6;      // [m] between two fixtures' centres

/// Two fixtures compared.
struct Candidate {
  int first = 0;
  int second = 0;
  double nis = 0.0;
  double sigma = 0.0;      // [m] largest 1-sigma of the position between them
  Eigen::Vector2d shift;   // [m] from the second to the first
  double travelled = 0.0;  // [m] where the second was first seen
};

class ClosureSearch {
 public:
  ClosureSearch(const SurveyEstimate& estimate, const Eigen::MatrixXd& covariance, const std::vector<KeyFrame>& frames,
                const std::vector<FixturePass>& passes, const CeilingKinds& kinds)
      : estimate_(estimate), covariance_(covariance), frames_(frames), passes_(passes), kinds_(kinds) {
    measure_spacing();
  }

  [[nodiscard]] LoopClosures search(const std::vector<PassPair>& banned) const {
    std::vector<std::vector<Candidate>> of_fixture(estimate_.fixtures.size());
    for (std::size_t j = 0; j < estimate_.fixtures.size(); ++j) {
      for (std::size_t i = 0; i < estimate_.fixtures.size(); ++i) {
        const std::optional<Candidate> candidate = compare(static_cast<int>(i), static_cast<int>(j));
        if (candidate && !is_banned(*candidate, banned)) {
          of_fixture[j].push_back(*candidate);
        }
      }
      std::sort(of_fixture[j].begin(), of_fixture[j].end(),
                [](const Candidate& a, const Candidate& b) { return a.nis < b.nis; });
    }
    LoopClosures closures;
    std::vector<Candidate> clear;
    for (std::size_t j = 0; j < of_fixture.size(); ++j) {
      const std::vector<Candidate>& found = of_fixture[j];
      if (found.empty() || found.front().nis > kGate) {
        continue;
      }
      if (is_clear(found, of_fixture)) {
        clear.push_back(found.front());
      } else {
        closures.doubts.push_back(doubt(found));
      }
    }
    for (const Candidate& candidate : clear) {
      // each pair is looked at from both of its ends
      if (candidate.first < candidate.second && has_support(candidate, clear)) {
        closures.sure.push_back({candidate.first, candidate.second});
      } else if (candidate.first < candidate.second) {
        closures.doubts.push_back({candidate.second, {candidate.first}, candidate.sigma});
      }
    }
    return closures;
  }

 private:
  [[nodiscard]] const SurveyedFixture& fixture(int index) const {
    return estimate_.fixtures[static_cast<std::size_t>(index)];
  }

  /// Distance to the nearest other fixture that is surely another one: both were passed within a few metres.
  void measure_spacing() {
    spacing_.assign(estimate_.fixtures.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < spacing_.size(); ++i) {
      for (std::size_t j = 0; j < spacing_.size(); ++j) {
        const double apart =
            distance(estimate_.fixtures[i].world_from_fixture, estimate_.fixtures[j].world_from_fixture);
        const double between = std::abs(first_seen(static_cast<int>(i)) - first_seen(static_cast<int>(j)));
        if (i != j && estimate_.fixtures[i].kind == estimate_.fixtures[j].kind && apart > kMinSpacing &&
            between < kNeighbourhood) {
          spacing_[i] = std::min(spacing_[i], apart);
        }
      }
    }
    std::vector<double> sorted = spacing_;
    std::sort(sorted.begin(), sorted.end());
    usual_spacing_ = sorted.empty() ? kMinSpacing : sorted[sorted.size() / 4];
  }

  [[nodiscard]] std::optional<Candidate> compare(int i, int j) const {
    const bool are_known = fixture(i).known >= 0 && fixture(j).known >= 0;
    if (i == j || are_known || fixture(i).kind != fixture(j).kind || share_a_frame(i, j)) {
      return std::nullopt;
    }
    const FixtureShape shape = kinds_.kinds[static_cast<std::size_t>(fixture(i).kind)].shape;
    const Pose2& a = fixture(i).world_from_fixture;
    const Pose2& b = fixture(j).world_from_fixture;
    const Eigen::Vector3d difference(a.x - b.x, a.y - b.y, wrap_modulo(a.theta - b.theta, symmetry_period(shape)));
    const auto block = [&](int row, int column) { return covariance_.block<3, 3>(3 * row, 3 * column); };
    Eigen::Matrix3d sum = block(i, i) + block(j, j) - block(i, j) - block(j, i);
    sum.diagonal() +=
        Eigen::Vector3d(std::pow(kPositionFloor, 2), std::pow(kPositionFloor, 2), std::pow(kHeadingFloor, 2));
    Candidate candidate;
    candidate.first = i;
    candidate.second = j;
    candidate.nis = difference.dot(sum.ldlt().solve(difference));
    if (candidate.nis > kOtherGate) {
      return std::nullopt;
    }
    const Eigen::Matrix2d position = sum.topLeftCorner<2, 2>();
    candidate.sigma = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position).eigenvalues().maxCoeff());
    candidate.shift = difference.head<2>();
    candidate.travelled = first_seen(std::max(i, j));
    return candidate;
  }

  /// Two that are in one picture are two.
  [[nodiscard]] bool share_a_frame(int i, int j) const {
    for (const int a : fixture(i).passes) {
      for (const int b : fixture(j).passes) {
        const auto& first = passes_[static_cast<std::size_t>(a)].sightings;
        const auto& second = passes_[static_cast<std::size_t>(b)].sightings;
        if (first.front().frame > second.back().frame || second.front().frame > first.back().frame) {
          continue;
        }
        const bool shared = std::any_of(first.begin(), first.end(), [&](const PassSighting& seen) {
          return std::any_of(second.begin(), second.end(),
                             [&](const PassSighting& other) { return other.frame == seen.frame; });
        });
        if (shared) {
          return true;
        }
      }
    }
    return false;
  }

  [[nodiscard]] double first_seen(int index) const {
    if (fixture(index).passes.empty()) {
      return 0.0;  // known before the drive
    }
    const FixturePass& pass = passes_[static_cast<std::size_t>(fixture(index).passes.front())];
    return frames_[static_cast<std::size_t>(pass.sightings.front().frame)].travelled;
  }

  /// The best one of a fixture, and it of the best one; no other within reach; and certain beside the spacing there.
  [[nodiscard]] bool is_clear(const std::vector<Candidate>& found,
                              const std::vector<std::vector<Candidate>>& of_fixture) const {
    const Candidate& best = found.front();
    const std::vector<Candidate>& back = of_fixture[static_cast<std::size_t>(best.first)];
    const double spacing = std::min({usual_spacing_, spacing_[static_cast<std::size_t>(best.first)],
                                     spacing_[static_cast<std::size_t>(best.second)]});
    return back.front().first == best.second && best.sigma <= kMaxShare * spacing && is_alone(found) && is_alone(back);
  }

  /// Whether the others within reach are, after all, that same one: passes of one fixture not yet joined.
  [[nodiscard]] bool is_alone(const std::vector<Candidate>& found) const {
    const Pose2& best = fixture(found.front().first).world_from_fixture;
    return std::all_of(found.begin() + 1, found.end(), [&](const Candidate& other) {
      return distance(fixture(other.first).world_from_fixture, best) < kMinSpacing;
    });
  }

  [[nodiscard]] bool has_support(const Candidate& candidate, const std::vector<Candidate>& clear) const {
    if (candidate.sigma <= kSureSigma) {
      return true;
    }
    return std::any_of(clear.begin(), clear.end(), [&](const Candidate& other) {
      return other.first < other.second && other.second != candidate.second && other.first != candidate.first &&
             std::abs(other.travelled - candidate.travelled) < kNeighbourhood &&
             (other.shift - candidate.shift).norm() < kAgreement;
    });
  }

  [[nodiscard]] bool is_banned(const Candidate& candidate, const std::vector<PassPair>& banned) const {
    const auto has = [&](int index, int pass) {
      const std::vector<int>& all = fixture(index).passes;
      return pass < 0 ? of_known(fixture(index).known) == pass : std::find(all.begin(), all.end(), pass) != all.end();
    };
    return std::any_of(banned.begin(), banned.end(), [&](const PassPair& pair) {
      return (has(candidate.first, pair.first) && has(candidate.second, pair.second)) ||
             (has(candidate.first, pair.second) && has(candidate.second, pair.first));
    });
  }

  [[nodiscard]] static ClosureDoubt doubt(const std::vector<Candidate>& found) {
    ClosureDoubt result;
    result.fixture = found.front().second;
    for (const Candidate& candidate : found) {
      result.candidates.push_back(candidate.first);
      result.sigma = std::max(result.sigma, candidate.sigma);
    }
    return result;
  }

  const SurveyEstimate& estimate_;
  const Eigen::MatrixXd& covariance_;
  const std::vector<KeyFrame>& frames_;
  const std::vector<FixturePass>& passes_;
  const CeilingKinds& kinds_;
  std::vector<double> spacing_;  // [m] per fixture
  double usual_spacing_ = 0.0;   // [m]
};

/// Mean place of a fixture by the sightings of one pass.
Pose2 placed_by(const FixturePass& pass, const std::vector<Pose2>& poses, const Pose2& near, double period) {
  Pose2 sum;
  for (const PassSighting& seen : pass.sightings) {
    const Pose2 at = poses[static_cast<std::size_t>(seen.frame)] * seen.sighting.robot_from_fixture;
    sum.x += at.x;
    sum.y += at.y;
    sum.theta += seen.sighting.has_theta ? wrap_modulo(at.theta - near.theta, period) : 0.0;
  }
  const auto count = static_cast<double>(pass.sightings.size());
  return {sum.x / count, sum.y / count, wrap_angle(near.theta + sum.theta / count)};
}

}  // namespace

LoopClosures find_closures(const SurveyEstimate& estimate, const Eigen::MatrixXd& covariance,
                           const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                           const CeilingKinds& kinds, const std::vector<PassPair>& banned) {
  return ClosureSearch(estimate, covariance, frames, passes, kinds).search(banned);
}

SurveyEstimate merge(SurveyEstimate estimate, const std::vector<FixturePair>& pairs) {
  std::vector<int> root(estimate.fixtures.size());
  std::iota(root.begin(), root.end(), 0);
  const auto root_of = [&](int index) {
    while (root[static_cast<std::size_t>(index)] != index) {
      index = root[static_cast<std::size_t>(index)];
    }
    return index;
  };
  for (const FixturePair& pair : pairs) {
    const int a = root_of(pair.first);
    const int b = root_of(pair.second);
    root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::vector<SurveyedFixture> merged;
  std::vector<int> place(estimate.fixtures.size(), -1);
  for (std::size_t i = 0; i < estimate.fixtures.size(); ++i) {
    const auto to = static_cast<std::size_t>(root_of(static_cast<int>(i)));
    if (to == i) {
      place[i] = static_cast<int>(merged.size());
      merged.push_back(estimate.fixtures[i]);
    } else {
      std::vector<int>& passes = merged[static_cast<std::size_t>(place[to])].passes;
      passes.insert(passes.end(), estimate.fixtures[i].passes.begin(), estimate.fixtures[i].passes.end());
      std::sort(passes.begin(), passes.end());
    }
  }
  estimate.fixtures = std::move(merged);
  return estimate;
}

std::vector<PassPair> split_what_disagrees(SurveyEstimate& estimate, const std::vector<FixturePass>& passes,
                                           const CeilingKinds& kinds, double limit, double limit_heading) {
  std::vector<PassPair> pairs;
  std::vector<SurveyedFixture> split;
  for (SurveyedFixture& fixture : estimate.fixtures) {
    if (fixture.passes.size() < 2 && fixture.known < 0) {
      continue;
    }
    const double period = symmetry_period(kinds.kinds[static_cast<std::size_t>(fixture.kind)].shape);
    std::vector<int> kept;
    for (const int pass : fixture.passes) {
      const Pose2 alone =
          placed_by(passes[static_cast<std::size_t>(pass)], estimate.poses, fixture.world_from_fixture, period);
      const bool agrees =
          distance(alone, fixture.world_from_fixture) <= limit &&
          std::abs(wrap_modulo(alone.theta - fixture.world_from_fixture.theta, period)) <= limit_heading;
      if (agrees) {
        kept.push_back(pass);
      } else {
        split.push_back({fixture.kind, {pass}, alone});
      }
    }
    if (fixture.known >= 0) {
      for (const int pass : fixture.passes) {
        if (std::find(kept.begin(), kept.end(), pass) == kept.end()) {
          pairs.push_back({of_known(fixture.known), pass});
        }
      }
    } else if (kept.empty()) {  // the passes are two heaps: one of them keeps the fixture
      kept.push_back(split.back().passes.front());
      fixture.world_from_fixture = split.back().world_from_fixture;
      split.pop_back();
    }
    for (const int pass : fixture.passes) {
      if (std::find(kept.begin(), kept.end(), pass) == kept.end()) {
        for (const int other : kept) {
          pairs.push_back({other, pass});
        }
      }
    }
    fixture.passes = kept;
  }
  estimate.fixtures.insert(estimate.fixtures.end(), split.begin(), split.end());
  return pairs;
}

}  // namespace luminav
