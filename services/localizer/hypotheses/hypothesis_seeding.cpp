#include "services/localizer/hypotheses/hypothesis_seeding.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kRingTurns = 24;        // that a round fixture's ring of poses is cut into
constexpr double kRingOverlap = 0.3;  // 1-sigma of a turn of it, as a share: uniform, and a little over its ends

/// Turns under which a sighting may be a fixture, and the heading's variance [rad^2] that each leaves open.
struct Turns {
  int count = 0;
  double step = 0.0;  // [rad]
  double variance = 0.0;
};

Turns turns_of(const FixtureSighting& sighting, FixtureShape shape) {
  if (shape == FixtureShape::kRound) {
    constexpr double kStep = 2.0 * kPi / kRingTurns;
    return {kRingTurns, kStep, kRingOverlap * kStep * kRingOverlap * kStep};
  }
  const double period = symmetry_period(shape);
  return {sighting.has_theta ? static_cast<int>(std::lround(2.0 * kPi / period)) : 0, period, 0.0};
}

}  // namespace

void HypothesisSeeding::abort() {
  seed_objects_.clear();
  seed_object_ = 0;
  taken_.reset();
  comparer_.reset();
}

void HypothesisSeeding::begin(const EvidenceRound& round, ObjectTracks& tracks, double sonar) {
  abort();
  round_ = &round;
  sonar_ = sonar;
  for (std::size_t i = 0; i < round.scene.objects().size(); ++i) {
    const ObjectTrack& object = round.scene.objects()[i];
    if (object.seeded || !object.is_visible || object.frames < 3 ||
        largest_position_sigma(object.best.covariance) > params_.seed_position_sigma) {
      continue;
    }
    seed_objects_.push_back(i);
    for (ObjectTrack& seen : tracks.objects()) {
      seen.seeded = seen.seeded || seen.id == object.id;
    }
  }
  if (seed_objects_.empty()) {
    return;
  }
  // What else was seen lately counts for the newcomers as for all others, carried here by odometry.
  const Pose2& odom_from_robot = round.odometry.odom_from_robot;
  recent_.sightings.clear();
  for (const ObjectTrack& object : round.scene.objects()) {
    FixtureSighting moved = object.best;
    moved.robot_from_fixture = odom_from_robot.inverse() * object.odom_from_object;
    const Pose2 step = object.odom_from_robot.inverse() * odom_from_robot;
    moved.covariance += odometry_noise_with_systematics(step, model_.wheel_base, model_.errors);
    recent_.sightings.push_back(moved);
  }
  comparer_.emplace(recent_, 0.0, 0.0, model_, params_);
}

std::vector<Hypothesis> HypothesisSeeding::next(const std::vector<Hypothesis>& known, WorkBudget& budget) {
  std::vector<Hypothesis> spawned;
  while (!is_complete() && !budget.is_spent()) {
    if (!taken_) {
      // those spawned of the seed object before were handed over, and are known now
      if (!spawned.empty()) {
        return spawned;
      }
      if (!budget.allows(static_cast<int>(known.size()) / 4)) {
        budget.close();
        return spawned;
      }
      begin_seed_object(known, budget);
    }
    while (fixture_ < model_.fixtures.size()) {
      if (budget.is_spent()) {
        return spawned;
      }
      const std::size_t before = spawned.size();
      spawn(model_.fixtures[fixture_++], known, spawned);
      budget.spend(1 + static_cast<int>(spawned.size() - before) * (4 + static_cast<int>(recent_.sightings.size())));
    }
    taken_.reset();
    ++seed_object_;
  }
  return spawned;
}

void HypothesisSeeding::begin_seed_object(const std::vector<Hypothesis>& known, WorkBudget& budget) {
  const ObjectTrack& object = round_->scene.objects()[seed_objects_[seed_object_]];
  sighting_ = object.best;
  sighting_.robot_from_fixture = round_->odometry.odom_from_robot.inverse() * object.odom_from_object;
  taken_.emplace(known.size());
  for (const Hypothesis& hypothesis : known) {
    taken_->add(hypothesis.belief.pose);
  }
  budget.spend(static_cast<int>(known.size()) / 4);
  fixture_ = 0;
}

void HypothesisSeeding::spawn(const Fixture& fixture, const std::vector<Hypothesis>& known,
                              std::vector<Hypothesis>& spawned) const {
  const Turns turns = turns_of(sighting_, fixture.shape);
  if (turns.count == 0 || !fits_kind_and_size(sighting_, fixture, KindGate{})) {
    return;
  }
  Eigen::Matrix3d noise =
      white_sighting_covariance(sighting_, fixture, model_.errors) +
      systematic_sighting_covariance(sighting_, model_.height_above_camera(), 0.3, 0.3, model_.errors);
  noise(2, 2) += fixture.shape == FixtureShape::kRound ? turns.variance - kNoAngle : 0.0;
  for (int turn = 0; turn < turns.count; ++turn) {
    Hypothesis hypothesis;
    hypothesis.belief.pose = fixture.world_from_fixture * Pose2{0.0, 0.0, wrap_angle(turn * turns.step)} *
                             sighting_.robot_from_fixture.inverse();
    const Eigen::Matrix3d inverse =
        expect_sighting(hypothesis.belief.pose, fixture.world_from_fixture).jacobian.inverse();
    hypothesis.belief.covariance = inverse * noise * inverse.transpose();
    const Pose2& pose = hypothesis.belief.pose;
    hypothesis.sonar = sonar_;
    const bool is_taken = taken_->any_near(pose, [&](std::size_t i) {
      if (!is_same_place(known[i].belief.pose, pose, params_)) {
        return false;
      }
      hypothesis.sonar = std::min(hypothesis.sonar, known[i].sonar);  // from there the same was heard
      return explains_seed_object(known[i]);
    });
    if (!is_taken && is_possible_place(hypothesis.belief)) {
      add_scene_evidence(hypothesis);
      spawned.push_back(std::move(hypothesis));
    }
  }
}

// A pose near the seed object's that does not explain it is another one: it must not keep out the right one beside it.
bool HypothesisSeeding::explains_seed_object(const Hypothesis& hypothesis) const {
  const int object = round_->scene.objects()[seed_objects_[seed_object_]].id;
  return std::any_of(hypothesis.votes.begin(), hypothesis.votes.end(),
                     [&](const ObjectVote& vote) { return vote.object == object && vote.fixture >= 0; });
}

bool HypothesisSeeding::is_possible_place(const PoseBelief& belief) const {
  if (!model_.walls.has_walls()) {
    return true;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(belief.covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d axis = solver.eigenvectors().col(1) * std::sqrt(solver.eigenvalues()(1));
  for (const double deviations : {0.0, 1.0, -1.0, 2.0, -2.0}) {
    const Eigen::Vector2d place = belief.pose.position() + deviations * axis;
    if (model_.walls.is_free(place) && model_.walls.distance_to_wall(place) > 0.10) {
      return true;
    }
  }
  return false;
}

void HypothesisSeeding::add_scene_evidence(Hypothesis& hypothesis) const {
  const FrameComparison comparison = comparer_->compare(hypothesis.belief);
  hypothesis.votes.reserve(round_->scene.objects().size());
  for (std::size_t i = 0; i < round_->scene.objects().size(); ++i) {
    const ObjectTrack& seen = round_->scene.objects()[i];
    add_evidence(hypothesis, seen, comparison.fixture_of_sighting[i], comparison.of(i, seen), 1.0, 1);
    hypothesis.votes.back().frames = seen.frames;
    hypothesis.votes.back().matches = comparison.fixture_of_sighting[i] >= 0 ? seen.frames : 0;
  }
}

}  // namespace luminav
