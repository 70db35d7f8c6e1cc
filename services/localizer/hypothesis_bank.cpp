#include "services/localizer/hypothesis_bank.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "services/localizer/place_table.hpp"

namespace luminav {
namespace {

double log_of_normal_tail(double deviations) {
  // log of the normal distribution function; below -5 nothing is told apart any more
  constexpr double kCertain = 8.5;  // beyond it the function is 1 to the last bit
  return deviations > kCertain ? 0.0 : std::log(std::max(3e-7, 0.5 * std::erfc(-deviations / std::sqrt(2.0))));
}

double symmetric_turns(FixtureShape shape) {
  return symmetry_period(shape) == 0.0 ? 0.0 : 2.0 * kPi / symmetry_period(shape);
}

}  // namespace

HypothesisBank::HypothesisBank(const FixtureMap& map, const CeilingView& view, const WallField& walls,
                               double ceiling_height, double wheel_base, const SonarRing& sonar,
                               const ErrorParams& errors, const HypothesisParams& params)
    : map_(map),
      view_(view),
      walls_(walls),
      ceiling_height_(ceiling_height),
      wheel_base_(wheel_base),
      sonar_(sonar),
      errors_(errors),
      params_(params) {}

void HypothesisBank::clear() {
  ++beginnings_;
  hypotheses_.clear();
  null_settled_ = 0.0;
  null_active_ = 0.0;
  best_sonar_ = 0.0;
  trail_.clear();
}

void HypothesisBank::advance(const Pose2& delta) {
  const Eigen::Matrix3d noise = odometry_noise_with_systematics(delta, wheel_base_, errors_);
  const double way = std::hypot(delta.x, delta.y);
  const bool has_stretch = trail_.advance(delta) && walls_.has_walls() && hypotheses_.size() > 1;
  const std::vector<Eigen::Vector2d> stretch = has_stretch ? trail_.points() : std::vector<Eigen::Vector2d>{};
  way_since_correction_ += way + 0.5 * std::abs(delta.theta);
  for (Hypothesis& hypothesis : hypotheses_) {
    predict(hypothesis.belief, delta, noise);
    if (walls_.has_walls() && way > 0.0) {
      // probability that the robot's middle is at least 0.1 m from the next wall cell, as it must be
      const double room = walls_.distance_to_wall(hypothesis.belief.pose.position()) - 0.10;
      const double sigma = std::max(0.05, position_sigma(hypothesis.belief.covariance));
      hypothesis.walls += log_of_normal_tail(room / sigma) * way / params_.wall_way;
    }
    if (has_stretch) {
      hypothesis.walls += log_likelihood_of_trail(hypothesis.belief, stretch, walls_);
    }
  }
}

void HypothesisBank::bridge(const Pose2& step, const Eigen::Matrix3d& noise) {
  trail_.clear();
  for (Hypothesis& hypothesis : hypotheses_) {
    predict(hypothesis.belief, step, noise);
    settle_all(hypothesis, params_);
  }
  null_settled_ += null_active_;
  null_active_ = 0.0;
  way_since_correction_ += params_.independent_way;
}

void HypothesisBank::observe(const SightingFrame& frame, const std::vector<int>& object_of_sighting, SceneMemory& scene,
                             const OdometryReading& odometry, double odometer) {
  // Constant errors are drawn anew only every `independent_way`: between, an image counts for its share of it.
  const double share = std::clamp(way_since_correction_ / params_.independent_way, 0.02, 1.0);
  way_since_correction_ = 0.0;
  null_active_ = 0.0;
  for (const SeenObject& object : scene.objects()) {
    null_active_ += params_.misfit * std::min(1.0, static_cast<double>(object.frames) / params_.frames_for_full_vote);
  }
  for (const SeenObject& object : scene.forgotten()) {
    null_settled_ += params_.misfit * std::min(1.0, static_cast<double>(object.frames) / params_.frames_for_full_vote);
  }
  const FrameComparer comparer(frame, odometry.linear, odometry.angular, map_, view_, ceiling_height_, errors_,
                               params_);
  for (Hypothesis& hypothesis : hypotheses_) {
    settle_what_is_over(hypothesis, scene, odometer, params_);
    const FrameComparison comparison = comparer.compare(hypothesis.belief);
    for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
      const SeenObject& object = scene.objects()[static_cast<std::size_t>(object_of_sighting[i])];
      // a sharp view tells more than one cut by the border
      const double sigma = largest_position_sigma(frame.sightings[i].covariance);
      vote(hypothesis, object, comparison.fixture_of_sighting[i], comparison.log_likelihood[i],
           1.0 / (1.0 + sigma * sigma / 0.01));
    }
    correct(hypothesis, comparer, comparison, frame, share);
    watch(hypothesis, comparison.expected, comparison.missed, odometer);
  }
}

void HypothesisBank::correct(Hypothesis& hypothesis, const FrameComparer& comparer, const FrameComparison& comparison,
                             const SightingFrame& frame, double share) const {
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    if (comparison.fixture_of_sighting[i] < 0) {
      continue;
    }
    hypothesis.last_match = frame.utime;
    const FixtureSighting& sighting = frame.sightings[i];
    const Fixture& fixture = map_[comparison.fixture_of_sighting[i]];
    Eigen::Matrix3d white = white_sighting_covariance(sighting, fixture, errors_);
    if (!sighting.has_theta || symmetry_period(fixture.shape) == 0.0) {
      white(2, 2) += kNoAngle;
    }
    const Eigen::Matrix3d noise = (white + comparer.systematic_error(i)) / share;
    // several corrections in one image: linearise each at the pose the one before it left
    const Innovation innovation = innovate(hypothesis.belief, sighting, fixture, noise);
    luminav::correct(hypothesis.belief, innovation, noise);
  }
}

bool HypothesisBank::is_same_place(const Pose2& a, const Pose2& b) const {
  return distance(a, b) < params_.merge_distance && std::abs(wrap_angle(a.theta - b.theta)) < params_.merge_angle;
}

bool HypothesisBank::is_possible_place(const PoseBelief& belief) const {
  if (!walls_.has_walls()) {
    return true;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(belief.covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d axis = solver.eigenvectors().col(1) * std::sqrt(solver.eigenvalues()(1));
  for (const double deviations : {0.0, 1.0, -1.0, 2.0, -2.0}) {
    const Eigen::Vector2d place = belief.pose.position() + deviations * axis;
    if (walls_.is_free(place) && walls_.distance_to_wall(place) > 0.10) {
      return true;
    }
  }
  return false;
}

std::vector<Hypothesis> HypothesisBank::poses_from(const SeenObject& object, const Pose2& odom_from_robot) const {
  std::vector<Hypothesis> born;
  FixtureSighting sighting = object.best;
  sighting.robot_from_fixture = odom_from_robot.inverse() * object.odom_from_object;
  const double height_above_camera = std::max(0.2, view_.height_above_camera(ceiling_height_));
  PlaceTable taken(hypotheses_.size());
  for (const Hypothesis& hypothesis : hypotheses_) {
    taken.add(hypothesis.belief.pose);
  }
  const auto is_taken = [&](const Pose2& pose) {
    return taken.any_near(pose, [&](std::size_t i) { return is_same_place(hypotheses_[i].belief.pose, pose); });
  };
  for (int index = 0; index < map_.size(); ++index) {
    const Fixture& fixture = map_[index];
    const int turns = sighting.has_theta ? static_cast<int>(std::lround(symmetric_turns(fixture.shape))) : 0;
    if (turns == 0 || !fits_kind_and_size(sighting, fixture, KindGate{})) {
      continue;
    }
    for (int turn = 0; turn < turns; ++turn) {
      Hypothesis hypothesis;
      hypothesis.belief.pose = fixture.world_from_fixture *
                               Pose2{0.0, 0.0, wrap_angle(turn * symmetry_period(fixture.shape))} *
                               sighting.robot_from_fixture.inverse();
      const Eigen::Matrix3d noise = white_sighting_covariance(sighting, fixture, errors_) +
                                    systematic_sighting_covariance(sighting, height_above_camera, 0.3, 0.3, errors_);
      const Eigen::Matrix3d inverse =
          expect_sighting(hypothesis.belief.pose, fixture.world_from_fixture).jacobian.inverse();
      hypothesis.belief.covariance = inverse * noise * inverse.transpose();
      if (!is_taken(hypothesis.belief.pose) && is_possible_place(hypothesis.belief)) {
        born.push_back(std::move(hypothesis));
      }
    }
  }
  return born;
}

SightingFrame HypothesisBank::recent_sightings(const SceneMemory& scene, const Pose2& odom_from_robot) const {
  SightingFrame recent;
  for (const SeenObject& object : scene.objects()) {
    FixtureSighting carried = object.best;
    carried.robot_from_fixture = odom_from_robot.inverse() * object.odom_from_object;
    const Pose2 step = object.odom_from_robot.inverse() * odom_from_robot;
    carried.covariance += odometry_noise_with_systematics(step, wheel_base_, errors_);
    recent.sightings.push_back(carried);
  }
  return recent;
}

int HypothesisBank::seed(SceneMemory& scene, const Pose2& odom_from_robot) {
  int added = 0;
  for (SeenObject& object : scene.objects()) {
    if (object.seeded || !object.is_visible || object.frames < 3 ||
        largest_position_sigma(object.best.covariance) > params_.seed_position_sigma) {
      continue;
    }
    object.seeded = true;
    // What else was seen lately counts for the newcomers as for all others, carried here by odometry.
    const SightingFrame recent = recent_sightings(scene, odom_from_robot);
    const FrameComparer comparer(recent, 0.0, 0.0, map_, view_, ceiling_height_, errors_, params_);
    for (Hypothesis& hypothesis : poses_from(object, odom_from_robot)) {
      hypothesis.settled = null_settled_;
      hypothesis.sonar = best_sonar_ - 1.0;
      const FrameComparison comparison = comparer.compare(hypothesis.belief);
      for (std::size_t i = 0; i < scene.objects().size(); ++i) {
        const SeenObject& seen = scene.objects()[i];
        vote(hypothesis, seen, comparison.fixture_of_sighting[i], comparison.log_likelihood[i], 1.0);
        hypothesis.votes.back().frames = seen.frames;
        hypothesis.votes.back().matches = comparison.fixture_of_sighting[i] >= 0 ? seen.frames : 0;
      }
      add(std::move(hypothesis));
      ++added;
    }
  }
  return added;
}

void HypothesisBank::add(Hypothesis hypothesis) {
  hypothesis.id = next_id_++;
  score(hypothesis, best_sonar_, params_);
  hypotheses_.push_back(std::move(hypothesis));
}

void HypothesisBank::add_guess(const PoseBelief& belief, double bonus) {
  Hypothesis guess;
  guess.belief = belief;
  guess.settled = null_settled_;
  guess.sonar = best_sonar_;
  guess.bonus = bonus;
  add(std::move(guess));
}

void HypothesisBank::listen(const std::vector<PlacedEcho>& echoes) {
  if (!walls_.has_walls() || echoes.empty() || hypotheses_.empty()) {
    return;
  }
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.sonar +=
        params_.sonar_weight * log_likelihood_of_echoes(hypothesis.belief, echoes, walls_, sonar_.half_angle);
  }
  best_sonar_ = -1e18;
  for (const Hypothesis& hypothesis : hypotheses_) {
    best_sonar_ = std::max(best_sonar_, hypothesis.sonar);
  }
}

void HypothesisBank::tidy() {
  if (hypotheses_.empty()) {
    return;
  }
  for (Hypothesis& hypothesis : hypotheses_) {
    score(hypothesis, best_sonar_, params_);
  }
  std::vector<std::size_t> order(hypotheses_.size());  // sorted in place of the hypotheses, which are large
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return hypotheses_[a].total > hypotheses_[b].total; });
  const double least = hypotheses_[order.front()].total - params_.prune;
  std::erase_if(order, [&](std::size_t i) {
    const Hypothesis& h = hypotheses_[i];
    return h.total < least || h.walls < -15.0 || !h.belief.covariance.allFinite();
  });
  if (order.size() > static_cast<std::size_t>(params_.most)) {
    order.resize(static_cast<std::size_t>(params_.most));
  }
  // the better of two that came together stays
  PlaceTable places(order.size());
  std::vector<Hypothesis> kept;
  kept.reserve(order.size());
  for (const std::size_t index : order) {
    const Pose2& pose = hypotheses_[index].belief.pose;
    const bool is_double =
        places.any_near(pose, [&](std::size_t i) { return is_same_place(kept[i].belief.pose, pose); });
    if (!is_double) {
      places.add(pose);
      kept.push_back(std::move(hypotheses_[index]));
    }
  }
  hypotheses_ = std::move(kept);
}

}  // namespace luminav
