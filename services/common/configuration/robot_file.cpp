#include "services/common/configuration/robot_file.hpp"

#include <algorithm>
#include <cmath>
#include <regex>

namespace luminav {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

std::vector<Eigen::Vector2d> read_footprint(const TomlTable& root) {
  std::vector<Eigen::Vector2d> footprint = root.points("footprint");
  if (footprint.size() < 3) {
    root.fail("footprint", "must be a list of at least three [x, y] corners in metres");
  }
  for (std::size_t i = 0; i < footprint.size(); ++i) {
    const Eigen::Vector2d& a = footprint[i];
    const Eigen::Vector2d& b = footprint[(i + 1) % footprint.size()];
    const Eigen::Vector2d& c = footprint[(i + 2) % footprint.size()];
    if (cross(b - a, c - b) < -1e-9) {
      root.fail("footprint", "must be convex, its corners counter-clockwise");
    }
    if (cross(a, b) <= 0.0) {
      root.fail("footprint", "must contain the origin, the middle of the drive axis");
    }
  }
  return footprint;
}

SonarRing read_sonar_ring(const TomlTable& root) {
  SonarRing ring;
  const TomlTable table = root.table("sonar_ring");
  ring.minimum_range = table.number("minimum_range", ring.minimum_range, {0.0, 1.0});
  ring.maximum_range = table.number("maximum_range", ring.maximum_range, {0.5, 20.0});
  ring.half_angle = table.number("half_angle", ring.half_angle, {0.01, 0.8});
  table.reject_unknown();
  for (const TomlTable& disc : root.tables("sonar")) {
    ring.robot_from_sonar.push_back(
        {disc.number("x", {-2.0, 2.0}), disc.number("y", {-2.0, 2.0}), wrap_angle(disc.number("theta", {-7.0, 7.0}))});
    disc.reject_unknown();
  }
  return ring;
}

MotionLimits read_limits(const TomlTable& table) {
  MotionLimits limits;
  limits.linear = table.number("linear", limits.linear, {0.02, 3.0});
  limits.angular = table.number("angular", limits.angular, {0.02, 6.0});
  limits.linear_acceleration = table.number("linear_acceleration", limits.linear_acceleration, {0.05, 5.0});
  limits.linear_deceleration = table.number("linear_deceleration", limits.linear_deceleration, {0.05, 5.0});
  limits.angular_acceleration = table.number("angular_acceleration", limits.angular_acceleration, {0.05, 20.0});
  table.reject_unknown();
  return limits;
}

CameraDescription read_camera(const TomlTable& table) {
  CameraDescription camera;
  CameraIntrinsics& lens = camera.intrinsics;
  lens.model =
      table.choice("model", "pinhole", {"pinhole", "fisheye"}) == "pinhole" ? LensModel::kPinhole : LensModel::kFisheye;
  lens.width = table.count("width", lens.width, {16, 8192});
  lens.height = table.count("height", lens.height, {16, 8192});
  lens.fx = table.number("fx", lens.fx, {1.0, 1e5});
  lens.fy = table.number("fy", lens.fx, {1.0, 1e5});
  lens.cx = table.number("cx", 0.5 * (lens.width - 1), {-1e4, 1e4});
  lens.cy = table.number("cy", 0.5 * (lens.height - 1), {-1e4, 1e4});
  const std::vector<double> distortion = table.numbers("distortion");
  if (distortion.size() > lens.distortion.size()) {
    table.fail("distortion", "must have at most 5 numbers: k1 k2 p1 p2 k3, of a fisheye k1 k2 k3 k4");
  }
  std::copy(distortion.begin(), distortion.end(), lens.distortion.begin());
  CameraMounting& mounting = camera.mounting;
  mounting.x = table.number("x", mounting.x, {-2.0, 2.0});
  mounting.y = table.number("y", mounting.y, {-2.0, 2.0});
  mounting.z = table.number("z", mounting.z, {0.0, 5.0});
  mounting.roll = table.number("roll", mounting.roll, {-1.0, 1.0});
  mounting.pitch = table.number("pitch", mounting.pitch, {-1.0, 1.0});
  mounting.yaw = table.number("yaw", mounting.yaw, {-7.0, 7.0});
  camera.time_offset = table.number("time_offset", camera.time_offset, {-1.0, 1.0});
  camera.row_time = table.number("row_time", 25e-3 / lens.height, {0.0, 1e-3});
  table.reject_unknown();
  return camera;
}

}  // namespace

double RobotDescription::swept_radius() const {
  double radius = 0.0;
  for (const Eigen::Vector2d& corner : footprint) {
    radius = std::max(radius, corner.norm());
  }
  return radius;
}

double RobotDescription::inscribed_radius() const {
  double radius = swept_radius();
  for (std::size_t i = 0; i < footprint.size(); ++i) {
    const Eigen::Vector2d& a = footprint[i];
    const Eigen::Vector2d edge = footprint[(i + 1) % footprint.size()] - a;
    radius = std::min(radius, std::abs(cross(edge, a)) / edge.norm());
  }
  return radius;
}

RobotDescription read_robot(const TomlTable& root) {
  RobotDescription robot;
  robot.name = root.text("name");
  (void)root.choice("base", "p3dx", {"p3dx", "create2"});  // for who needs it: robot_base.hpp
  robot.mode = root.choice("mode", robot.mode, {"paper", "modern"});
  robot.footprint = read_footprint(root);
  robot.wheel_base = root.number("wheel_base", robot.wheel_base, {0.05, 3.0});
  robot.sonar = read_sonar_ring(root);
  robot.limits = read_limits(root.table("limits"));
  robot.camera = read_camera(root.table("camera"));
  for (const char* node : {"p3dx", "create2", "camera_driver", "detector", "localizer", "mapper", "planner",
                           "controller", "jobs", "viewer", "network"}) {
    root.accept(node);
  }
  root.reject_unknown();
  return robot;
}

RobotDescription read_robot(const std::filesystem::path& file) {
  return read_robot(TomlTable::load(file));
}

std::string with_mode(const std::string& robot_toml, const std::string& mode) {
  // nothing else in the file has that name
  static const std::regex kModeLine(R"((^|\n)[ \t]*mode[ \t]*=[^\n]*)");
  return "mode = \"" + mode + "\"\n" + std::regex_replace(robot_toml, kModeLine, "$1");
}

}  // namespace luminav
