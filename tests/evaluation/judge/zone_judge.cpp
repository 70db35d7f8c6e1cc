#include "tests/evaluation/judge/zone_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/simulator/geometry/shapes.hpp"
#include "services/common/building/lane_map.hpp"
#include "services/common/building/standing_room.hpp"
#include "services/common/process/channels.hpp"
#include "tests/evaluation/judge/map_score.hpp"

namespace luminav {
namespace {

constexpr double kRadius = 0.40;              // [m] what is as wide is passable, whatever the grid makes of it
constexpr double kSpacing = 0.02;             // [m] of points on the outline
constexpr double kNear = 1.0;                 // [m] from the outline's middle: else a zone is far
constexpr std::int64_t kEvery = 50'000;       // [us]
constexpr std::int64_t kBraking = 1'000'000;  // [us] since it knows where it is

// What may be broken, by how much, before it counts.
constexpr double kKeepOut = 0.01;    // [m]
constexpr double kLeaving = 60.0;    // [s] turning included
constexpr double kOverSpeed = 0.05;  // [m/s]
constexpr double kAgainst = 0.10;    // [m]
constexpr double kPathRatio = 1.3;
constexpr double kPathSlack = 0.5;  // [m] of turning round at both ends

}  // namespace

ZoneJudge::ZoneJudge(lcm::LCM& lcm, std::vector<Zone> zones, LocalClock local_clock, const WorldTruth& world)
    : zones_(std::move(zones), std::move(local_clock)),
      world_(world),
      progress_(zones_.all().size()),
      subscriber_(lcm) {
  if (!zones_.all().empty()) {
    subscriber_.on(channels::kPose, &ZoneJudge::on_pose, this);
    subscriber_.on(channels::kSimTruth, &ZoneJudge::on_truth, this);
  }
}

void ZoneJudge::on_pose(const pose_t& pose) {
  if (pose.state != pose_t::STATE_TRACKING) {
    tracking_since_ = 0;
  } else if (tracking_since_ == 0) {
    tracking_since_ = pose.utime;
  }
}

void ZoneJudge::on_truth(const sim_truth_t& truth) {
  if (truth.utime - last_truth_ < kEvery) {
    return;
  }
  const double seconds = 1e-6 * static_cast<double>(std::min(truth.utime - last_truth_, 2 * kEvery));
  last_truth_ = truth.utime;
  if (zones_.tell(truth.utime)) {
    was_outside_ = false;                                      // of one that has just begun
    tracking_since_ = tracking_since_ == 0 ? 0 : truth.utime;  // it brakes for a slow one
  }
  if (tracking_since_ == 0 || truth.carried) {
    was_outside_ = false;
    inside_ = 0.0;
    std::fill(progress_.begin(), progress_.end(), std::nullopt);
    return;
  }
  const Pose2 robot{truth.x, truth.y, truth.theta};
  judge_keep_out(robot, seconds);
  judge_lanes(robot);
  for (const Zone& zone : zones_.in_force()) {
    if (zone.kind == ZoneKind::kSlow && contains(zone.polygon, robot.position()) &&
        truth.utime - tracking_since_ > kBraking) {
      result_.over_speed_m_s = std::max(result_.over_speed_m_s, std::abs(truth.linear) - zone.speed);
    }
  }
}

void ZoneJudge::judge_keep_out(const Pose2& robot, double seconds) {
  double depth = 0.0;
  for (const Zone& zone : zones_.in_force()) {
    const bool is_near =
        contains(zone.polygon, robot.position()) || distance_to_edge(zone.polygon, robot.position()) < kNear;
    if (zone.kind == ZoneKind::kKeepOut && is_near) {
      depth = std::max(depth, overlap_depth(transform(robot, world_.robot.footprint), zone.polygon, kSpacing));
    }
  }
  if (was_outside_) {
    result_.keep_out_m = std::max(result_.keep_out_m, depth);
    return;
  }
  was_outside_ = depth == 0.0;
  inside_ = was_outside_ ? 0.0 : inside_ + seconds;
  result_.leaving_s = std::max(result_.leaving_s, inside_);
}

void ZoneJudge::judge_lanes(const Pose2& robot) {
  for (std::size_t i = 0; i < zones_.all().size(); ++i) {
    const Zone& zone = zones_.all()[i];
    if (!zones_.is_in_force(i) || zone.kind != ZoneKind::kOneWay || !contains(zone.polygon, robot.position())) {
      progress_[i].reset();
      continue;
    }
    const double along = robot.position().dot(direction_of(zone));
    progress_[i] = std::max(progress_[i].value_or(along), along);
    result_.against_m = std::max(result_.against_m, *progress_[i] - along);
  }
}

double ZoneJudge::shortest(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const std::vector<Zone>& zones = zones_.in_force();
  return octile_length(with_keep_out(world_.walls, zones), from, to, kRadius, LaneMap(zones, world_.walls.geometry));
}

void ZoneJudge::compare(double driven, double shortest) {
  if (shortest > 0.0 && driven / shortest > result_.path_ratio) {
    result_.path_ratio = driven / shortest;
    result_.path_m = driven;
  }
}

std::optional<ZoneResult> ZoneJudge::result() const {
  return zones_.all().empty() ? std::nullopt : std::optional(result_);
}

std::string ZoneJudge::failure(const std::vector<GoalResult>& goals) const {
  if (result_.keep_out_m > kKeepOut) {
    return fmt::format("{:.3f} m of the outline were in a keep-out zone", result_.keep_out_m);
  }
  if (result_.leaving_s > kLeaving) {
    return fmt::format("stayed in a keep-out zone for {:.0f} s", result_.leaving_s);
  }
  if (result_.over_speed_m_s > kOverSpeed) {
    return fmt::format("{:.2f} m/s too fast in a slow zone", result_.over_speed_m_s);
  }
  if (result_.against_m > kAgainst) {
    return fmt::format("drove {:.2f} m against a one-way zone", result_.against_m);
  }
  if (result_.path_m - kPathSlack > kPathRatio * result_.path_m / std::max(result_.path_ratio, 1e-9)) {
    return fmt::format("drove {:.1f} m, {:.2f} times the shortest allowed way", result_.path_m, result_.path_ratio);
  }
  for (const GoalResult& goal : goals) {
    const bool is_named = std::any_of(zones_.all().begin(), zones_.all().end(), [&](const Zone& zone) {
      return goal.cause.find(zone.name) != std::string::npos;
    });
    if (!zones_.all().empty() && goal.expect_refused && goal.refused && !is_named) {
      return "refused without naming a zone: " + goal.cause;
    }
  }
  return "";
}

}  // namespace luminav
