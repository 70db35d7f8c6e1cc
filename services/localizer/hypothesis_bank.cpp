#include "services/localizer/hypothesis_bank.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "services/localizer/place_table.hpp"

namespace luminav {
namespace {

constexpr double kPassedBy = 1.5;  // [m] driven since a fixture was expected last: its pass is over
constexpr std::size_t kMostConfirmed = 16;

double log_of_normal_tail(double deviations) {
  // log of the normal distribution function; below -5 nothing is told apart any more
  return std::log(std::max(3e-7, 0.5 * std::erfc(-deviations / std::sqrt(2.0))));
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
      height_above_camera_(std::max(0.2, view.height_above_camera(ceiling_height))),
      view_radius_(view.radius(ceiling_height)),
      wheel_base_(wheel_base),
      sonar_(sonar),
      errors_(errors),
      params_(params) {}

void HypothesisBank::clear() {
  hypotheses_.clear();
  null_settled_ = 0.0;
  null_active_ = 0.0;
  best_sonar_ = 0.0;
}

void HypothesisBank::advance(const Pose2& delta) {
  const Eigen::Matrix3d noise = odometry_noise_with_systematics(delta, wheel_base_, errors_);
  const double way = std::hypot(delta.x, delta.y);
  way_since_correction_ += way + 0.5 * std::abs(delta.theta);
  for (Hypothesis& hypothesis : hypotheses_) {
    predict(hypothesis.belief, delta, noise);
    if (walls_.has_walls() && way > 0.0) {
      // probability that the robot's middle is at least 0.1 m from the next wall cell, as it must be
      const double room = walls_.distance_to_wall(hypothesis.belief.pose.position()) - 0.10;
      const double sigma = std::max(0.05, position_sigma(hypothesis.belief.covariance));
      hypothesis.walls += log_of_normal_tail(room / sigma) * way / params_.wall_way;
    }
  }
}

std::vector<Eigen::Matrix3d> HypothesisBank::systematic_errors(const SightingFrame& frame, double linear,
                                                               double angular) const {
  std::vector<Eigen::Matrix3d> errors;
  errors.reserve(frame.sightings.size());
  for (const FixtureSighting& sighting : frame.sightings) {
    errors.push_back(systematic_sighting_covariance(sighting, height_above_camera_, linear, angular, errors_));
  }
  return errors;
}

FrameComparison HypothesisBank::compare(const PoseBelief& belief, const SightingFrame& frame,
                                        const std::vector<Eigen::Matrix3d>& systematic) const {
  struct Pair {
    std::size_t sighting = 0;
    int fixture = 0;
    double log_likelihood = 0.0;
    Innovation innovation;
  };
  FrameComparison result;
  result.fixture_of_sighting.assign(frame.sightings.size(), -1);
  result.log_likelihood.assign(frame.sightings.size(), params_.misfit);
  result.innovations.resize(frame.sightings.size());
  thread_local std::vector<int> near;
  near.clear();
  map_.find_near(belief.pose.position(), view_radius_ + 1.0, near);
  thread_local std::vector<Pair> pairs;
  pairs.clear();
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    const Eigen::Vector2d place = belief.pose * sighting.robot_from_fixture.position();
    for (const int index : near) {
      const Fixture& fixture = map_[index];
      if ((fixture.world_from_fixture.position() - place).squaredNorm() > 2.25 ||
          !fits_kind_and_size(sighting, fixture, KindGate{})) {
        continue;
      }
      const Eigen::Matrix3d noise = white_sighting_covariance(sighting, fixture, errors_) + systematic[i];
      const Innovation innovation = innovate(belief, sighting, fixture, noise);
      if (innovation.nis < params_.gate) {
        pairs.push_back({i, index,
                         std::max(params_.misfit, -0.5 * innovation.nis - std::min(3.0, innovation.log_volume)),
                         innovation});
      }
    }
  }
  // one-to-one, the best pair first: fixtures stand so far apart that a better sum of worse pairs does not occur
  if (pairs.size() > 1) {
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.innovation.nis < b.innovation.nis; });
  }
  thread_local std::vector<int> taken;
  taken.clear();
  for (const Pair& pair : pairs) {
    if (result.fixture_of_sighting[pair.sighting] >= 0 ||
        std::find(taken.begin(), taken.end(), pair.fixture) != taken.end()) {
      continue;
    }
    result.fixture_of_sighting[pair.sighting] = pair.fixture;
    result.log_likelihood[pair.sighting] = pair.log_likelihood;
    result.innovations[pair.sighting] = pair.innovation;
    taken.push_back(pair.fixture);
  }
  const double margin = params_.miss_margin + 2.0 * position_sigma(belief.covariance);
  const Pose2 robot_from_world = belief.pose.inverse();
  const PointTransform to_robot(robot_from_world);
  for (const int index : near) {
    const Fixture& fixture = map_[index];
    const Eigen::Vector2d centre = to_robot * fixture.world_from_fixture.position();
    const Pose2 robot_from_fixture{centre.x(), centre.y(),
                                   wrap_angle(robot_from_world.theta + fixture.world_from_fixture.theta)};
    if (!view_.is_wholly_visible(robot_from_fixture, fixture, margin)) {
      continue;
    }
    result.expected.push_back(index);
    const bool something_there =
        std::any_of(frame.sightings.begin(), frame.sightings.end(), [&](const FixtureSighting& s) {
          return distance(s.robot_from_fixture, robot_from_fixture) < 0.5 * fixture.length + 0.2;
        });
    if (!something_there) {
      result.missed.push_back(index);
    }
  }
  return result;
}

void HypothesisBank::vote(Hypothesis& hypothesis, const SeenObject& object, int fixture, double log_likelihood,
                          double weight) {
  auto found = std::find_if(hypothesis.votes.begin(), hypothesis.votes.end(),
                            [&](const ObjectVote& v) { return v.object == object.id; });
  if (found == hypothesis.votes.end()) {
    hypothesis.votes.push_back({});
    found = hypothesis.votes.end() - 1;
    found->object = object.id;
  }
  found->weight += weight;
  found->weighted_sum += weight * log_likelihood;
  ++found->frames;
  found->fixture = fixture;
  if (fixture >= 0) {
    ++found->matches;
    if (found->matches >= 3 && 2 * found->matches > found->frames && hypothesis.confirmed.size() < kMostConfirmed &&
        std::find(hypothesis.confirmed.begin(), hypothesis.confirmed.end(), fixture) == hypothesis.confirmed.end()) {
      hypothesis.confirmed.push_back(fixture);
    }
  }
}

void HypothesisBank::score(Hypothesis& hypothesis) const {
  double total = hypothesis.settled + hypothesis.walls + hypothesis.bonus +
                 std::max(-params_.sonar_cap, std::min(0.0, hypothesis.sonar - best_sonar_));
  for (const ObjectVote& vote : hypothesis.votes) {
    total += vote.weighted_sum / std::max(1e-9, vote.weight) *
             std::min(1.0, static_cast<double>(vote.frames) / params_.frames_for_full_vote);
  }
  for (const FixtureWatch& watch : hypothesis.watches) {
    const double share = static_cast<double>(watch.missed) / std::max(1, watch.expected);
    total += std::log(1.0 - (1.0 - params_.miss_probability) * share) *
             std::min(1.0, static_cast<double>(watch.expected) / params_.frames_for_full_miss);
  }
  hypothesis.total = total;
}

void HypothesisBank::settle(Hypothesis& hypothesis, std::vector<ObjectVote> votes,
                            std::vector<FixtureWatch> watches) const {
  if (votes.empty() && watches.empty()) {
    return;
  }
  Hypothesis over;
  over.votes = std::move(votes);
  over.watches = std::move(watches);
  over.sonar = best_sonar_;
  score(over);
  hypothesis.settled += over.total;
}

void HypothesisBank::settle(Hypothesis& hypothesis, const SceneMemory& scene, double odometer) {
  std::vector<ObjectVote> votes;
  const auto is_forgotten = [&](const ObjectVote& vote) {
    return std::any_of(scene.forgotten().begin(), scene.forgotten().end(),
                       [&](const SeenObject& o) { return o.id == vote.object; });
  };
  if (!scene.forgotten().empty()) {
    std::copy_if(hypothesis.votes.begin(), hypothesis.votes.end(), std::back_inserter(votes), is_forgotten);
    std::erase_if(hypothesis.votes, is_forgotten);
  }
  std::vector<FixtureWatch> watches;
  const auto is_passed = [&](const FixtureWatch& watch) { return odometer - watch.odometer > kPassedBy; };
  std::copy_if(hypothesis.watches.begin(), hypothesis.watches.end(), std::back_inserter(watches), is_passed);
  std::erase_if(hypothesis.watches, is_passed);
  settle(hypothesis, std::move(votes), std::move(watches));
}

void HypothesisBank::bridge(const Pose2& step, const Eigen::Matrix3d& noise) {
  for (Hypothesis& hypothesis : hypotheses_) {
    predict(hypothesis.belief, step, noise);
    settle(hypothesis, std::move(hypothesis.votes), std::move(hypothesis.watches));
    hypothesis.votes.clear();
    hypothesis.watches.clear();
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
  const std::vector<Eigen::Matrix3d> systematic = systematic_errors(frame, odometry.linear, odometry.angular);
  for (Hypothesis& hypothesis : hypotheses_) {
    settle(hypothesis, scene, odometer);
    const FrameComparison comparison = compare(hypothesis.belief, frame, systematic);
    for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
      const FixtureSighting& sighting = frame.sightings[i];
      const SeenObject& object = scene.objects()[static_cast<std::size_t>(object_of_sighting[i])];
      // a sharp view tells more than one cut by the border
      const double sigma = largest_position_sigma(sighting.covariance);
      vote(hypothesis, object, comparison.fixture_of_sighting[i], comparison.log_likelihood[i],
           1.0 / (1.0 + sigma * sigma / 0.01));
      if (comparison.fixture_of_sighting[i] < 0) {
        continue;
      }
      hypothesis.last_match = frame.utime;
      const Fixture& fixture = map_[comparison.fixture_of_sighting[i]];
      Eigen::Matrix3d white = white_sighting_covariance(sighting, fixture, errors_);
      if (!sighting.has_theta || symmetry_period(fixture.shape) == 0.0) {
        white(2, 2) += kNoAngle;
      }
      const Eigen::Matrix3d noise = (white + systematic[i]) / share;
      // several corrections in one image: linearise each at the pose the one before it left
      Innovation innovation = innovate(hypothesis.belief, sighting, fixture, noise);
      correct(hypothesis.belief, innovation, noise);
    }
    for (const int index : comparison.expected) {
      auto watch = std::find_if(hypothesis.watches.begin(), hypothesis.watches.end(),
                                [&](const FixtureWatch& w) { return w.fixture == index; });
      if (watch == hypothesis.watches.end()) {
        hypothesis.watches.push_back({index, 0, 0, odometer});
        watch = hypothesis.watches.end() - 1;
      }
      ++watch->expected;
      watch->odometer = odometer;
      watch->missed +=
          std::find(comparison.missed.begin(), comparison.missed.end(), index) != comparison.missed.end() ? 1 : 0;
    }
  }
}

bool HypothesisBank::is_taken(const Pose2& pose) const {
  return std::any_of(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& h) {
    return distance(h.belief.pose, pose) < params_.merge_distance &&
           std::abs(wrap_angle(h.belief.pose.theta - pose.theta)) < params_.merge_angle;
  });
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

int HypothesisBank::seed(SceneMemory& scene, const Pose2& odom_from_robot) {
  int added = 0;
  for (SeenObject& object : scene.objects()) {
    if (object.seeded || !object.is_visible || object.frames < 3 ||
        largest_position_sigma(object.best.covariance) > params_.seed_position_sigma) {
      continue;
    }
    object.seeded = true;
    std::vector<Hypothesis> born;
    const Pose2 robot_from_object = odom_from_robot.inverse() * object.odom_from_object;
    FixtureSighting sighting = object.best;
    sighting.robot_from_fixture = robot_from_object;
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
                                 robot_from_object.inverse();
        const Eigen::Matrix3d noise = white_sighting_covariance(sighting, fixture, errors_) +
                                      systematic_sighting_covariance(sighting, height_above_camera_, 0.3, 0.3, errors_);
        const Eigen::Matrix3d inverse =
            expect_sighting(hypothesis.belief.pose, fixture.world_from_fixture).jacobian.inverse();
        hypothesis.belief.covariance = inverse * noise * inverse.transpose();
        if (is_possible_place(hypothesis.belief) && !is_taken(hypothesis.belief.pose)) {
          born.push_back(std::move(hypothesis));
        }
      }
    }
    // What else was seen lately counts for the newcomers as for all others, carried here by odometry.
    SightingFrame recent;
    std::vector<const SeenObject*> others;
    for (const SeenObject& other : scene.objects()) {
      FixtureSighting carried = other.best;
      carried.robot_from_fixture = odom_from_robot.inverse() * other.odom_from_object;
      const Pose2 step = other.odom_from_robot.inverse() * odom_from_robot;
      carried.covariance += odometry_noise_with_systematics(step, wheel_base_, errors_);
      recent.sightings.push_back(carried);
      others.push_back(&other);
    }
    const std::vector<Eigen::Matrix3d> systematic = systematic_errors(recent, 0.0, 0.0);
    for (Hypothesis& hypothesis : born) {
      hypothesis.settled = null_settled_;
      hypothesis.sonar = best_sonar_ - 1.0;
      const FrameComparison comparison = compare(hypothesis.belief, recent, systematic);
      for (std::size_t i = 0; i < others.size(); ++i) {
        vote(hypothesis, *others[i], comparison.fixture_of_sighting[i], comparison.log_likelihood[i], 1.0);
        hypothesis.votes.back().frames = others[i]->frames;
        hypothesis.votes.back().matches = comparison.fixture_of_sighting[i] >= 0 ? others[i]->frames : 0;
      }
      add(std::move(hypothesis));
      ++added;
    }
  }
  return added;
}

void HypothesisBank::add(Hypothesis hypothesis) {
  hypothesis.id = next_id_++;
  score(hypothesis);
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

void HypothesisBank::listen(const std::vector<Echo>& echoes) {
  if (!walls_.has_walls() || echoes.empty() || hypotheses_.empty()) {
    return;
  }
  constexpr double kFromWall = 0.6;  // share of echoes that come from the building's walls
  for (Hypothesis& hypothesis : hypotheses_) {
    const Pose2& pose = hypothesis.belief.pose;
    const double sigma = 0.12 + position_sigma(hypothesis.belief.covariance);
    double sum = 0.0;
    for (const Echo& echo : echoes) {
      const Eigen::Vector2d axis = echo.end - echo.disc;
      double nearest = 1e9;
      double farthest_wall = 0.0;
      const Eigen::Vector2d disc = pose * echo.disc;
      for (const double across : {-0.7, 0.0, 0.7}) {
        const double turn = across * sonar_.half_angle;
        const Eigen::Vector2d offset(std::cos(turn) * axis.x() - std::sin(turn) * axis.y(),
                                     std::sin(turn) * axis.x() + std::cos(turn) * axis.y());
        const Eigen::Vector2d end = pose * Eigen::Vector2d(echo.disc + offset);
        nearest = std::min(nearest, walls_.distance_to_wall(end));
        farthest_wall = std::max(farthest_wall, walls_.range_to_wall(disc, (end - disc).normalized(), echo.range));
      }
      const double hit = nearest / sigma;
      sum += std::log(1.0 + kFromWall / (1.0 - kFromWall) * std::exp(-0.5 * hit * hit));
      // an echo from behind a wall: only a map that is wrong there explains it
      if (farthest_wall < echo.range - 0.3 - 2.0 * sigma) {
        sum -= 0.7;
      }
    }
    hypothesis.sonar += params_.sonar_weight * sum;
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
    score(hypothesis);
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
    const bool is_double = places.any_near(pose, [&](std::size_t i) {
      return distance(kept[i].belief.pose, pose) < params_.merge_distance &&
             std::abs(wrap_angle(kept[i].belief.pose.theta - pose.theta)) < params_.merge_angle;
    });
    if (!is_double) {
      places.add(pose);
      kept.push_back(std::move(hypotheses_[index]));
    }
  }
  hypotheses_ = std::move(kept);
}

}  // namespace luminav
