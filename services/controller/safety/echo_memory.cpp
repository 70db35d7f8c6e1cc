#include "services/controller/safety/echo_memory.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kKeepNear = 2.5;               // [s] an echo within `kNear`, where sonar may be blind to it
constexpr double kKeepRepeated = 2.5;           // [s] what a disc heard that repeats itself, until that is found out
constexpr double kNear = 0.45;                  // [m] from the disc
constexpr double kRemember = 8.0;               // [s] for choosing a direction; what stands near, for stopping too
constexpr double kSpacing = 0.06;               // [m] between the points that stand for an arc
constexpr double kRefuteMargin = 0.12;          // [m] an echo this much farther clears what was nearer in its cone
constexpr double kWallTolerance = 0.15;         // [m] an arc with a mapped wall this near is that wall
constexpr double kRefuteAngle = radians(25.0);  // [rad] between the axes of two firings: farther echoes clear no more
constexpr double kSamePlace = 0.08;             // [m] between two firings of a disc that see the same
constexpr double kSameHeading = radians(6.0);   // [rad]
constexpr double kAlong = 0.03;                 // [m] of own motion along its axis: a disc's range has to change
constexpr double kMinApproach = 0.25;           // [m/s] slower than this is noise
constexpr double kMaxApproach = 1.4;            // [m/s] a brisk walk
constexpr double kStandsAfter = 0.5;            // [s] what was heard there this long ago stands
constexpr double kStandsWithin = 0.12;          // [m]
constexpr double kApproachAtOnce =
    1.1;  // [m] nearer than this one sign of approach is enough, farther off it takes two

/// Is a point of one list nearer than a distance [m] to a point of the other?
bool are_within(const std::vector<Eigen::Vector2d>& some, const std::vector<Eigen::Vector2d>& others, double distance) {
  return std::any_of(some.begin(), some.end(), [&](const Eigen::Vector2d& one) {
    return std::any_of(others.begin(), others.end(),
                       [&](const Eigen::Vector2d& other) { return (one - other).squaredNorm() < distance * distance; });
  });
}

}  // namespace

EchoMemory::EchoMemory(const SonarRing& ring, const EchoMemoryParams& params) : ring_(ring), params_(params) {
  for (const Pose2& disc : ring_.robot_from_sonar) {
    Sector sector{-ring_.half_angle, ring_.half_angle};
    for (const Pose2& other : ring_.robot_from_sonar) {
      const double apart = wrap_angle(other.theta - disc.theta);
      if (std::abs(apart) < radians(2.0)) {
        continue;  // the same direction from another place
      }
      (apart > 0.0 ? sector.left : sector.right) =
          apart > 0.0 ? std::min(sector.left, 0.5 * apart) : std::max(sector.right, 0.5 * apart);
    }
    sectors_.push_back(sector);
  }
  newest_.resize(ring_.robot_from_sonar.size());
  approaching_.resize(ring_.robot_from_sonar.size());
}

void EchoMemory::clear() {
  echoes_.clear();
  std::fill(newest_.begin(), newest_.end(), SonarFiring{});
  std::fill(approaching_.begin(), approaching_.end(), false);
}

// How fast the thing ahead of the disc comes nearer beyond the robot's own motion. Only between two echoes of one disc
// while the robot hardly turned: a turning cone slides along a wall.
double EchoMemory::approach_speed(const SonarFiring& firing) const {
  const SonarFiring& last = newest_[firing.disc];
  const double passed = seconds_between(last.utime, firing.utime);
  const Pose2 last_from_now = last.odom_from_robot.inverse() * firing.odom_from_robot;
  if (last.utime == 0 || passed <= 0.0 || passed > 0.8 || std::abs(last_from_now.theta) > radians(4.0)) {
    return 0.0;
  }
  const double axis = ring_.robot_from_sonar[firing.disc].theta;
  const double own = last_from_now.x * std::cos(axis) + last_from_now.y * std::sin(axis);
  const double nearer = last.range - firing.range - std::max(0.0, own);
  const double speed = nearer / passed;
  // faster than people walk is another thing that came into the cone
  return speed < kMinApproach || speed > kMaxApproach ? 0.0 : speed;
}

// Does the disc say what it said, though the robot has moved along its axis since? It may be stuck: then its echo moves
// on with the robot, and must not refute what it heard before.
bool EchoMemory::repeats_itself(const SonarFiring& firing) const {
  const SonarFiring& last = newest_[firing.disc];
  return last.utime != 0 && hear_the_same(last, firing) && moved_along_axis(ring_, last, firing) > kAlong;
}

// Is one of its points where another echo came from a while ago? Somebody who walks has gone on since.
bool EchoMemory::was_heard_before(const Echo& echo) const {
  return std::any_of(echoes_.begin(), echoes_.end(), [&](const Echo& older) {
    return seconds_between(older.utime, echo.utime) >= kStandsAfter &&
           are_within(older.points_in_odom, echo.points_in_odom, kStandsWithin);
  });
}

// A farther echo through the same directions takes back what was thought to stand nearer. Silence refutes only what the
// same disc heard from the same place: a smooth wall seen at another slant is silent too. What has left the cone that
// hears farther, a post at its edge, stands where it stood, even if the disc has turned by a degree only.
void EchoMemory::refute(const SonarFiring& firing) {
  const Pose2 odom_from_sonar = firing.odom_from_robot * ring_.robot_from_sonar[firing.disc];
  const PointTransform sonar_from_odom(odom_from_sonar.inverse());
  const double cone = 0.8 * ring_.half_angle;
  const auto angle_of = [](const Eigen::Vector2d& seen) { return std::abs(std::atan2(seen.y(), seen.x())); };
  std::vector<Eigen::Vector2d> gone;
  for (Echo& echo : echoes_) {
    const bool is_same_view =
        echo.disc == firing.disc && is_near(echo.odom_from_robot, firing.odom_from_robot, kSamePlace, kSameHeading);
    if (is_same_view && firing.range > echo.range + kRefuteMargin) {
      std::erase_if(echo.points_in_odom, [&](const Eigen::Vector2d& point) {
        const bool is_gone = !firing.has_echo || angle_of(sonar_from_odom * point) < cone;
        if (is_gone) {
          gone.push_back(point);
        }
        return is_gone;
      });
      continue;
    }
    if (!firing.has_echo) {
      continue;
    }
    // from another side a smooth wall may be silent while what stands behind it, or in its mirror, is heard
    if (std::abs(wrap_angle(odom_from_sonar.theta - echo.axis_in_odom)) > kRefuteAngle) {
      continue;
    }
    std::erase_if(echo.points_in_odom, [&](const Eigen::Vector2d& point) {
      const Eigen::Vector2d seen = sonar_from_odom * point;
      const double range = seen.norm();
      return range > ring_.minimum_range && range < firing.range - kRefuteMargin && angle_of(seen) < cone;
    });
  }
  if (!gone.empty()) {
    remember_less_beside(gone);
  }
}

void EchoMemory::remember_less_beside(const std::vector<Eigen::Vector2d>& gone) {
  for (Echo& echo : echoes_) {
    echo.may_be_gone = echo.may_be_gone || are_within(echo.points_in_odom, gone, kStandsWithin);
  }
}

void EchoMemory::keep_longer(std::size_t disc) {
  for (Echo& echo : echoes_) {
    if (echo.disc == disc) {
      echo.keep = std::max(echo.keep, kKeepRepeated);
    }
  }
}

void EchoMemory::add(const SonarFiring& firing, const WallTest& is_wall) {
  if (firing.disc >= newest_.size() || firing.utime <= newest_[firing.disc].utime) {
    return;
  }
  const double oldest = std::max({params_.keep, kKeepNear, kKeepRepeated, kRemember});
  std::erase_if(echoes_, [&](const Echo& echo) {
    return echo.points_in_odom.empty() || seconds_between(echo.utime, firing.utime) > oldest;
  });
  const bool last_had_echo = newest_[firing.disc].has_echo;
  if (repeats_itself(firing)) {
    keep_longer(firing.disc);
  } else {
    refute(firing);
  }
  if (firing.has_echo) {
    Echo echo;
    echo.disc = firing.disc;
    echo.range = firing.range;
    echo.odom_from_robot = firing.odom_from_robot;
    echo.utime = firing.utime;
    const double speed = last_had_echo ? approach_speed(firing) : 0.0;
    // seen twice running it is believed; seen once only where waiting for the second time would be too long
    echo.approach = approaching_[firing.disc] || firing.range < kApproachAtOnce ? speed : 0.0;
    approaching_[firing.disc] = speed > 0.0;
    echo.keep = firing.range < kNear ? kKeepNear : params_.keep;
    const Pose2 odom_from_sonar = firing.odom_from_robot * ring_.robot_from_sonar[firing.disc];
    echo.axis_in_odom = odom_from_sonar.theta;
    const double range = std::max(firing.range, 0.02);
    const PointTransform to_odom(odom_from_sonar);
    const auto point_at = [&](double angle) {
      return Eigen::Vector2d(to_odom * Eigen::Vector2d(range * std::cos(angle), range * std::sin(angle)));
    };
    const int steps = std::clamp(static_cast<int>(std::ceil(2.0 * ring_.half_angle * range / kSpacing)), 2, 12);
    if (is_wall) {
      // The whole cone counts here: a door post at its edge explains the echo and leaves the doorway open.
      for (int i = 0; i <= steps; ++i) {
        const Eigen::Vector2d point = point_at(ring_.half_angle * (2.0 * i / steps - 1.0));
        if (is_wall(point, kWallTolerance)) {
          echo.points_in_odom.push_back(point);
        }
      }
      echo.is_known = !echo.points_in_odom.empty();
    }
    if (echo.is_known) {
      echo.approach = 0.0;
    }
    if (!echo.is_known) {
      const Sector& sector = sectors_[firing.disc];
      for (int i = 0; i <= steps; ++i) {
        echo.points_in_odom.push_back(point_at(sector.right + (sector.left - sector.right) * i / steps));
      }
    }
    echo.has_stood = echo.is_known || was_heard_before(echo);
    echoes_.push_back(std::move(echo));
  }
  newest_[firing.disc] = firing;
}

std::vector<ObstaclePoint> EchoMemory::points_of(std::int64_t now, const Pose2& odom_from_robot, double longest,
                                                 double longest_near) const {
  std::vector<ObstaclePoint> result;
  const PointTransform robot_from_odom(odom_from_robot.inverse());
  std::size_t count = 0;
  for (const Echo& echo : echoes_) {
    count += echo.points_in_odom.size();
  }
  result.reserve(count);
  for (const Echo& echo : echoes_) {
    const double age = std::max(0.0, seconds_between(echo.utime, now));
    const bool is_near = echo.range < kNear;
    // a rear corner swings where no disc looks, and at a slant a thing is silent: it stands there all the same
    const double standing = is_near && echo.has_stood && !echo.is_known ? kRemember : 0.0;
    const double longer = std::max(standing, is_near ? longest_near : longest);
    if (age > std::max(echo.keep, echo.may_be_gone ? 0.0 : longer)) {
      continue;
    }
    // after half a second a newer firing has the say about who approaches
    const double approach = age < 0.5 ? echo.approach : 0.0;
    for (const Eigen::Vector2d& point : echo.points_in_odom) {
      result.push_back({robot_from_odom * point, approach, age, echo.is_known, echo.has_stood});
    }
  }
  return result;
}

std::vector<ObstaclePoint> EchoMemory::obstacles(std::int64_t now, const Pose2& odom_from_robot) const {
  return points_of(now, odom_from_robot, 0.0, 0.0);
}

std::vector<ObstaclePoint> EchoMemory::obstacles_without_map(std::int64_t now, const Pose2& odom_from_robot) const {
  return points_of(now, odom_from_robot, 0.0, kRemember);
}

std::vector<ObstaclePoint> EchoMemory::remembered(std::int64_t now, const Pose2& odom_from_robot) const {
  return points_of(now, odom_from_robot, kRemember, kRemember);
}

}  // namespace luminav
