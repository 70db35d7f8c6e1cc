#include "services/localizer/pose_memory.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "services/common/configuration/toml_lines.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;    // [us]
constexpr std::int64_t kPatience = 5'000'000;  // [us] in doubt after which a pose is forgotten
constexpr double kFarthest = 5.0;              // [m] driven without this process
constexpr double kUnseenDistance = 0.05;       // [m per m] odometry's error, whatever way it took
constexpr double kMinPosition = 0.05;          // [m] 1-sigma added
constexpr double kMinHeading = radians(3.0);   // [rad]
constexpr double kUnseenTurn = radians(5.0);   // [rad per m] of unseen way

/// The remembered pose carried to where odometry stands now; nothing when the session is another one, so that nobody
/// knows how the robot moved meanwhile, or when it drove so far that odometry alone does not tell enough.
std::optional<PoseBelief> carry_forward(const RememberedPose& remembered, const OdometryReading& odometry) {
  const Pose2 delta = remembered.odom_from_robot.inverse() * odometry.odom_from_robot;
  const double distance = std::hypot(delta.x, delta.y);
  if (odometry.session != remembered.session || distance > kFarthest) {
    return std::nullopt;
  }
  PoseBelief belief = remembered.belief;
  belief.pose = belief.pose * delta;
  const double position = kMinPosition + kUnseenDistance * distance;
  const double heading = kMinHeading + kUnseenTurn * distance;
  belief.covariance += Eigen::Vector3d(position * position, position * position, heading * heading).asDiagonal();
  return belief;
}

}  // namespace

PoseMemory::PoseMemory(const std::filesystem::path& folder, const Building& building)
    : file_(folder.empty() ? std::filesystem::path() : folder / "localizer_pose.toml"),
      building_(building.name),
      fixtures_(static_cast<int>(building.fixtures.size())) {}

std::optional<PoseBelief> PoseMemory::recall(const OdometryReading& odometry) {
  if (std::exchange(is_recalled_, true)) {
    return std::nullopt;
  }
  const auto remembered = load();
  if (!remembered || remembered->building != building_ || remembered->fixtures != fixtures_) {
    return std::nullopt;
  }
  auto belief = carry_forward(*remembered, odometry);
  if (belief) {
    is_remembered_ = true;
    saved_utime_ = odometry.utime;
  }
  return belief;
}

void PoseMemory::remember(const OdometryReading& odometry, const LocalizerEstimate& estimate) {
  if (estimate.state != LocalizerState::kTracking) {
    if (is_remembered_ && odometry.utime - saved_utime_ > kPatience) {
      forget();  // better none than one that is in doubt
    }
  } else if (odometry.utime - saved_utime_ >= kPeriod) {
    saved_utime_ = odometry.utime;
    is_remembered_ = true;
    has_failed_ = !save({building_, fixtures_, odometry.session, odometry.odom_from_robot, estimate.belief});
  }
}

void PoseMemory::restart() {
  forget();
  saved_utime_ = 0;
}

std::optional<RememberedPose> PoseMemory::load() const {
  std::error_code error;
  if (file_.empty() || !std::filesystem::exists(file_, error)) {
    return std::nullopt;
  }
  try {
    const TomlTable table = TomlTable::load(file_);
    RememberedPose pose;
    pose.building = table.text("building");
    pose.fixtures = static_cast<int>(table.integer("fixtures", {0.0, 1e9}));
    pose.session = table.integer("session");
    const std::vector<double> odom = table.numbers("odom_from_robot", 3);
    const std::vector<double> world = table.numbers("world_from_robot", 3);
    const std::vector<double> covariance = table.numbers("covariance", 9);
    if (odom.size() != 3 || world.size() != 3 || covariance.size() != 9) {
      return std::nullopt;
    }
    pose.odom_from_robot = {odom[0], odom[1], odom[2]};
    pose.belief.pose = {world[0], world[1], world[2]};
    pose.belief.covariance = Eigen::Map<const Eigen::Matrix3d>(covariance.data());
    return pose.belief.covariance.allFinite() && pose.belief.covariance.diagonal().minCoeff() > 0.0
               ? std::optional(pose)
               : std::nullopt;
  } catch (const ConfigurationError&) {
    return std::nullopt;  // a damaged memory is none
  }
}

bool PoseMemory::save(const RememberedPose& pose) const {
  if (file_.empty()) {
    return true;
  }
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  const auto list = [](const Pose2& p) { return fmt::format("[{:.9f}, {:.9f}, {:.9f}]", p.x, p.y, p.theta); };
  try {
    write_whole_file(
        file_,
        fmt::format("building = {}\nfixtures = {}\nsession = {}\nodom_from_robot = {}\nworld_from_robot = {}\n"
                    "covariance = [{:.9e}]\n",
                    quoted(pose.building), pose.fixtures, pose.session, list(pose.odom_from_robot),
                    list(pose.belief.pose), fmt::join(pose.belief.covariance.reshaped(), ", ")),
        Durability::kRenamed);
  } catch (const std::runtime_error&) {
    return false;
  }
  return true;
}

void PoseMemory::forget() {
  is_remembered_ = false;
  std::error_code error;
  if (!file_.empty()) {
    std::filesystem::remove(file_, error);
  }
}

}  // namespace luminav
