#include "services/localizer/integrity/motion_by_sonar.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxRounds = 10;  // each some 0.3 m or 30 degrees after the one before
constexpr double kMinRatio = 1.5;       // log; echoes of one surface have the weight of one, see EchoCollector
constexpr std::array<MotionBySonar::Motion, 5> kMotions = {
    {{0.25, 0.0}, {0.5, 0.0}, {0.75, 0.0}, {1.0, radians(10.0)}, {1.0, radians(-10.0)}}};

}  // namespace

/// Poses of all rounds: by the wheels up to one, otherwise after it.
std::vector<Pose2> MotionBySonar::path(const Pose2& world_from_robot, std::size_t begins, const Motion& motion) const {
  std::vector<Pose2> poses = {world_from_robot *
                              (rounds_.back().odom_from_robot.inverse() * rounds_.front().odom_from_robot)};
  for (std::size_t i = 1; i < rounds_.size(); ++i) {
    Pose2 step = rounds_[i - 1].odom_from_robot.inverse() * rounds_[i].odom_from_robot;
    if (i > begins) {
      step = {motion.grip * step.x, motion.grip * step.y, motion.grip * step.theta};
    }
    poses.push_back(i == begins + 1 ? poses.back() * Pose2{0.0, 0.0, motion.turn} * step : poses.back() * step);
  }
  return poses;
}

void MotionBySonar::listen(std::span<const PlacedEcho> echoes, const Pose2& odom_from_robot, const PoseBelief& belief) {
  if (!walls_.has_walls()) {
    return;
  }
  rounds_.push_back({{echoes.begin(), echoes.end()}, odom_from_robot});
  if (rounds_.size() > kMaxRounds) {
    rounds_.pop_front();
  }
  const std::vector<Pose2> by_wheels = path(belief.pose, 0, {});
  double max = kMinRatio;
  std::vector<double> own;  // log-likelihood by round
  for (std::size_t i = 0; i < rounds_.size(); ++i) {
    own.push_back(log_likelihood(rounds_[i], by_wheels[i], belief.covariance));
  }
  for (std::size_t begins = 0; begins + 1 < rounds_.size(); ++begins) {
    for (const Motion& motion : kMotions) {
      const std::vector<Pose2> moved = path(belief.pose, begins, motion);
      double ratio = 0.0;
      for (std::size_t i = begins + 1; i < rounds_.size(); ++i) {
        ratio += log_likelihood(rounds_[i], moved[i], belief.covariance) - own[i];
      }
      if (ratio > max) {
        max = ratio;
        moved_ = moved.back();
      }
    }
  }
}

double MotionBySonar::log_ratio(const Pose2& moved, const PoseBelief& belief, const Pose2& odom_from_robot) const {
  double sum = 0.0;   // since the motion, if it was before this round
  double mean = 0.0;  // over the rounds before which it may have been
  for (auto round = rounds_.rbegin(); round != rounds_.rend(); ++round) {
    const Pose2 then = odom_from_robot.inverse() * round->odom_from_robot;
    sum += log_likelihood(*round, moved * then, belief.covariance) -
           log_likelihood(*round, belief.pose * then, belief.covariance);
    mean += std::exp(sum) / static_cast<double>(rounds_.size());
  }
  return rounds_.empty() ? 0.0 : std::log(mean);
}

std::optional<Pose2> MotionBySonar::take() {
  const std::optional<Pose2> moved = std::exchange(moved_, std::nullopt);
  if (moved) {
    rounds_.clear();
  }
  return moved;
}

void MotionBySonar::clear() {
  rounds_.clear();
  moved_.reset();
}

}  // namespace luminav
