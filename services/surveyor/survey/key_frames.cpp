#include "services/surveyor/survey/key_frames.hpp"

#include <cmath>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/odometry_history.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kMaxGap = 2'000'000;     // [us] without odometry that are an arc,
constexpr double kUnheardDistance = 0.3;        // [m] if the robot moves farther
constexpr double kUnheardTurn = radians(20.0);  // [rad] or turns more
constexpr double kBlurShare = 0.5;              // of the blur, by which a lit bar looks longer

/// Collects the motion since the key frame before, and says when the next one is due.
class Approach {
 public:
  void add(const Pose2& step) {
    steps_.push_back(step);
    travelled_ += std::hypot(step.x, step.y);
  }
  void begin_part() {
    steps_.clear();
    is_first_ = true;
    ++part_;
  }
  [[nodiscard]] bool is_due(const Pose2& odom_from_robot) const {
    const Pose2 since = last_.inverse() * odom_from_robot;
    return is_first_ || std::hypot(since.x, since.y) >= kKeyFrameSpacing || std::abs(since.theta) >= kKeyFrameTurn;
  }
  KeyFrame take(const OdometryReading& at) {
    KeyFrame frame;
    frame.utime = at.utime;
    frame.part = part_;
    frame.travelled = travelled_;
    frame.odom_from_robot = at.odom_from_robot;
    frame.linear = at.linear;
    frame.angular = at.angular;
    if (!is_first_) {
      frame.steps = steps_;
    }
    steps_.clear();
    last_ = at.odom_from_robot;
    is_first_ = false;
    return frame;
  }

 private:
  std::vector<Pose2> steps_;
  Pose2 last_;
  double travelled_ = 0.0;  // [m]
  int part_ = 0;
  bool is_first_ = true;
};

/// Whether nobody measured how the robot came from one reading to the next: its wheels began to count anew, or it drove
/// on while nothing was heard of it, and who knows which way.
bool is_apart(const OdometryReading& before, const OdometryReading& now) {
  const Pose2 step = before.odom_from_robot.inverse() * now.odom_from_robot;
  const bool has_moved = std::hypot(step.x, step.y) > kUnheardDistance || std::abs(step.theta) > kUnheardTurn;
  return now.session != before.session || (now.utime - before.utime > kMaxGap && has_moved);
}

/// Where the motion is unknown: times [us] of the last odometry of a part and of the first of the next.
struct PartBreak {
  std::int64_t end = 0;
  std::int64_t begin = 0;
};

/// `told` [us]: breaks that somebody else found, in the order of time.
std::vector<PartBreak> find_breaks(const std::vector<OdometryReading>& odometry,
                                   const std::vector<std::int64_t>& told) {
  std::vector<PartBreak> breaks;
  auto next = told.begin();
  for (std::size_t i = 1; i < odometry.size(); ++i) {
    const bool is_told = next != told.end() && *next <= odometry[i].utime;
    next += is_told ? 1 : 0;
    if (is_told || is_apart(odometry[i - 1], odometry[i])) {
      breaks.push_back({odometry[i - 1].utime, odometry[i].utime});
    }
  }
  return breaks;
}

/// A lit bar with the length that it would show at rest. While the picture is exposed it moves on by some distance; at
/// a lamp that saturates the blur's outer half looks as bright as the lamp. So it looks longer by half of the distance
/// along it. What moves across it looks like bloom, which was taken off the length as well.
FixtureSighting without_motion_blur(FixtureSighting sighting, const OdometryReading& motion, double exposure) {
  const Pose2& at = sighting.robot_from_fixture;
  const Eigen::Vector2d moved =
      exposure * Eigen::Vector2d(motion.linear - motion.angular * at.y, motion.angular * at.x);
  const Eigen::Vector2d along(std::cos(at.theta), std::sin(at.theta));
  const double across = along.x() * moved.y() - along.y() * moved.x();
  if (sighting.state == SightingState::kLit) {
    sighting.length -= kBlurShare * (std::abs(along.dot(moved)) - std::abs(across));
  }
  return sighting;
}

}  // namespace

double signed_length(const Pose2& step) {
  return (step.x >= 0.0 ? 1.0 : -1.0) * std::hypot(step.x, step.y);
}

std::vector<KeyFrame> choose_key_frames(const SurveyDrive& drive, const CameraDescription& camera,
                                        double ceiling_height, const std::vector<std::int64_t>& breaks) {
  const CeilingView view(camera);
  const auto offset = static_cast<std::int64_t>(std::lround(1e6 * camera.time_offset));
  std::vector<KeyFrame> frames;
  Approach approach;
  std::size_t next = 0;
  const std::vector<PartBreak> part_breaks = find_breaks(drive.odometry, breaks);
  auto part_break = part_breaks.begin();
  for (std::size_t i = 1; i < drive.odometry.size(); ++i) {
    OdometryReading before = drive.odometry[i - 1];
    const OdometryReading& now = drive.odometry[i];
    if (part_break != part_breaks.end() && part_break->begin == now.utime) {
      approach.begin_part();
      ++part_break;
      continue;
    }
    for (; next < drive.frames.size() && drive.frames[next].utime + offset <= now.utime; ++next) {
      const std::int64_t utime = drive.frames[next].utime + offset;
      if (utime <= before.utime) {
        continue;
      }
      const OdometryReading at = interpolate(before, now, utime);
      const bool is_last = part_break != part_breaks.end() && next + 1 < drive.frames.size() &&
                           drive.frames[next + 1].utime + offset > part_break->end;
      if (!is_last && !approach.is_due(at.odom_from_robot)) {
        continue;
      }
      approach.add(before.odom_from_robot.inverse() * at.odom_from_robot);
      KeyFrame frame = approach.take(at);
      frame.has_lengths = drive.has_lengths;
      for (const FixtureSighting& sighting : drive.frames[next].sightings) {
        frame.sightings.push_back(
            without_motion_blur(view.without_rolling_shutter(sighting, ceiling_height, at.linear, at.angular), at,
                                drive.frames[next].exposure));
      }
      frames.push_back(std::move(frame));
      before = at;
    }
    approach.add(before.odom_from_robot.inverse() * now.odom_from_robot);
  }
  return frames;
}

}  // namespace luminav
