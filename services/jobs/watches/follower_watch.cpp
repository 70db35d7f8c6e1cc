#include "services/jobs/watches/follower_watch.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kBody = 0.2;                // [m] from his front to his middle
constexpr double kCrumb = 0.1;               // [m] between two points of the trail
constexpr std::size_t kCrumbs = 80;          // as far as it may have to go back
constexpr double kBeside = 0.3;              // [m] that he may walk off the trail
constexpr double kStride = 0.6;              // [m] between two echoes of one person
constexpr double kTwice = 1.0;               // [s] between them
constexpr double kWallSlack = 0.25;          // [m] that a wall may be farther than its echo: people stand before walls
constexpr double kConeSlack = radians(3.0);  // a pose's error
constexpr double kRaySpacing = radians(3.0);

Vector2d along(const Echo& echo, double off_axis, double range) {
  return echo.world_from_sonar * Vector2d(range * std::cos(off_axis), range * std::sin(off_axis));
}

}  // namespace

bool FollowerWatch::update(const std::vector<Echo>& echoes, double seconds, double driven,
                           const std::optional<Pose2>& world_from_robot) {
  if (!world_from_robot) {
    return false;
  }
  bool is_near = false;
  alone_ += driven;
  since_heard_ += seconds;
  remember(world_from_robot->position());
  for (const Echo& echo : echoes) {
    const std::optional<Vector2d> point = echo.range <= params_.reach ? find_on_trail(echo) : std::nullopt;
    if (!point || is_wall(echo)) {
      continue;
    }
    is_near = is_near || (heard_ && since_heard_ < kTwice && (*heard_ - *point).norm() < kStride);
    heard_ = point;
    since_heard_ = 0.0;
  }
  alone_ = is_near ? 0.0 : alone_;
  return is_near;
}

void FollowerWatch::remember(const Vector2d& point) {
  if (trail_.empty() || (trail_.back() - point).norm() > kCrumb) {
    trail_.push_back(point);
  }
  if (trail_.size() > kCrumbs) {
    trail_.pop_front();
  }
}

std::optional<Vector2d> FollowerWatch::find_on_trail(const Echo& echo) const {
  for (const Vector2d& crumb : trail_) {
    const Vector2d seen = echo.world_from_sonar.inverse() * crumb;
    const double off_axis = std::clamp(std::atan2(seen.y(), seen.x()), -echo.half_angle, echo.half_angle);
    const Vector2d point = along(echo, off_axis, echo.range + kBody);
    if ((point - crumb).norm() < kBeside) {
      return point;
    }
  }
  return std::nullopt;
}

bool FollowerWatch::is_wall(const Echo& echo) const {
  if (!walls_) {
    return false;
  }
  const double step = 0.5 * walls_->geometry.resolution;
  const double half_angle = echo.half_angle + kConeSlack;
  for (double off_axis = -half_angle; off_axis <= half_angle; off_axis += kRaySpacing) {
    for (double range = 0.0; range <= echo.range + kWallSlack; range += step) {
      if (walls_->at(along(echo, off_axis, range)) == Prior::kOccupied) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace luminav
