#include "services/localizer/integrity/slip_by_sonar.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr std::size_t kMaxRounds = 10;  // each some 0.3 m or 30 degrees after the one before
constexpr double kMinRatio = 1.0;       // log; echoes of one surface have the weight of one, see EchoCollector
constexpr std::array kGrips = {0.25, 0.5, 0.75};  // share of the wheels' motion that the robot made

Pose2 scaled(const Pose2& step, double grip) {
  return {grip * step.x, grip * step.y, grip * step.theta};
}

}  // namespace

/// Poses of all rounds: by the wheels up to one, with less grip after it.
std::vector<Pose2> SlipBySonar::path(const Pose2& world_from_robot, std::size_t slips_from, double grip) const {
  const Pose2 world_from_odom = world_from_robot * rounds_.back().odom_from_robot.inverse();
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < rounds_.size(); ++i) {
    const Pose2& odom_from_robot = rounds_[i].odom_from_robot;
    poses.push_back(i <= slips_from
                        ? world_from_odom * odom_from_robot
                        : poses.back() * scaled(rounds_[i - 1].odom_from_robot.inverse() * odom_from_robot, grip));
  }
  return poses;
}

void SlipBySonar::listen(std::span<const PlacedEcho> echoes, const Pose2& odom_from_robot, const PoseBelief& belief) {
  if (!walls_.has_walls()) {
    return;
  }
  rounds_.push_back({{echoes.begin(), echoes.end()}, odom_from_robot});
  if (rounds_.size() > kMaxRounds) {
    rounds_.pop_front();
  }
  const std::size_t count = rounds_.size();
  const std::vector<Pose2> by_wheels = path(belief.pose, count, 1.0);
  double max = kMinRatio;
  std::vector<double> own;  // log-likelihood by round
  for (std::size_t i = 0; i < count; ++i) {
    own.push_back(log_likelihood(rounds_[i], by_wheels[i], belief.covariance));
  }
  for (std::size_t slips_from = 0; slips_from + 1 < count; ++slips_from) {
    for (const double grip : kGrips) {
      const std::vector<Pose2> slipping = path(belief.pose, slips_from, grip);
      double ratio = 0.0;
      for (std::size_t i = slips_from + 1; i < count; ++i) {
        ratio += log_likelihood(rounds_[i], slipping[i], belief.covariance) - own[i];
      }
      if (ratio > max) {
        max = ratio;
        slipped_ = slipping.back();
      }
    }
  }
}

double SlipBySonar::log_ratio(const Pose2& moved, const PoseBelief& belief, const Pose2& odom_from_robot) const {
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

std::optional<Pose2> SlipBySonar::take() {
  const std::optional<Pose2> slipped = std::exchange(slipped_, std::nullopt);
  if (slipped) {
    rounds_.clear();
  }
  return slipped;
}

void SlipBySonar::clear() {
  rounds_.clear();
  slipped_.reset();
}

}  // namespace luminav
