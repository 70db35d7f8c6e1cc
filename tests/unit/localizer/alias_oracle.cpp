#include "tests/unit/localizer/alias_oracle.hpp"

#include <algorithm>
#include <cmath>

namespace luminav::testing {
namespace {

constexpr double kInView = 0.8;               // share of a fixture that is surely seen
constexpr double kAlike = 0.25;               // [m]
constexpr double kAlikeTurn = radians(12.0);  // [rad]
constexpr double kInWall = 0.10;              // [m]

bool is_same_kind(const Fixture& a, const Fixture& b) {
  return a.shape == b.shape && std::abs(a.length - b.length) < 0.15 && std::abs(a.width - b.width) < 0.08;
}

}  // namespace

AliasOracle::AliasOracle(const SyntheticWorld& world)
    : map_(world.believed().fixtures),
      walls_(world.map_walls()),
      view_(world.believed_robot().camera),
      radius_(view_.radius(world.believed().ceiling_height) + 1.0) {}

void AliasOracle::follow(const Pose2& truth) {
  if (!has_begun_) {
    begin(truth);
    last_ = truth;
    return;
  }
  const Pose2 step = last_.inverse() * truth;
  last_ = truth;
  for (Pose2& alias : aliases_) {
    alias = alias * step;
  }
  std::erase_if(aliases_, [&](const Pose2& alias) { return is_refuted(truth, alias); });
}

void AliasOracle::begin(const Pose2& truth) {
  for (int from = 0; from < map_.size() && !has_begun_; ++from) {
    const Pose2 robot_from_fixture = truth.inverse() * map_[from].world_from_fixture;
    const double period = symmetry_period(map_[from].shape);
    if (period == 0.0 || view_.visible_share(robot_from_fixture, map_[from], 0.0) < kInView) {
      continue;
    }
    has_begun_ = true;
    for (int to = 0; to < map_.size(); ++to) {
      for (int turn = 0; is_same_kind(map_[from], map_[to]) && turn < std::lround(2.0 * kPi / period); ++turn) {
        const Pose2 alias =
            map_[to].world_from_fixture * Pose2{0.0, 0.0, wrap_angle(turn * period)} * robot_from_fixture.inverse();
        if (distance(alias, truth) > kAlike || std::abs(wrap_angle(alias.theta - truth.theta)) > kAlikeTurn) {
          aliases_.push_back(alias);
        }
      }
    }
    std::erase_if(aliases_, [&](const Pose2& alias) { return is_refuted(truth, alias); });
  }
}

bool AliasOracle::is_refuted(const Pose2& truth, const Pose2& alias) const {
  return !walls_.is_free(alias.position()) || walls_.distance_to_wall(alias.position()) < kInWall ||
         !explains(alias, truth) || !explains(truth, alias);
}

bool AliasOracle::explains(const Pose2& pose, const Pose2& seen_from) const {
  const std::vector<int> near = map_.near(seen_from.position(), radius_);
  return std::all_of(near.begin(), near.end(), [&](int index) {
    const Fixture& fixture = map_[index];
    const Pose2 robot_from_fixture = seen_from.inverse() * fixture.world_from_fixture;
    if (view_.visible_share(robot_from_fixture, fixture, 0.0) < kInView) {
      return true;
    }
    const Pose2 expected = pose * robot_from_fixture;
    const std::vector<int> there = map_.near(expected.position(), kAlike);
    return std::any_of(there.begin(), there.end(), [&](int other) {
      const Fixture& candidate = map_[other];
      return is_same_kind(fixture, candidate) &&
             std::abs(wrap_modulo(expected.theta - candidate.world_from_fixture.theta,
                                  symmetry_period(candidate.shape))) < kAlikeTurn;
    });
  });
}

}  // namespace luminav::testing
