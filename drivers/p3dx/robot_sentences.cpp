#include "drivers/p3dx/robot_sentences.hpp"

#include <fmt/format.h>

#include <cmath>

namespace luminav {

std::string trouble_of(const ArcosLink& link) {
  return link.trouble().empty() ? "the robot does not answer" : link.trouble();
}

std::string describe_line(const ArcosLink& link, double maximum_linear, double deceleration) {
  if (!link.connected()) {
    return trouble_of(link);
  }
  const ConfigurationPacket& robot = link.configuration();
  const std::string who = fmt::format("connected with \"{}\" ({})", link.identity().name, link.identity().subclass);
  if (!link.has_configuration()) {
    return who + "; it does not tell its configuration, that of a p3dx-sh is assumed";
  }
  if (robot.watchdog == 0) {
    return who + "; its watchdog is OFF: without driver and guardian it would not stop";
  }
  const double distance = maximum_linear * 1e-3 * robot.watchdog + 0.5 * maximum_linear * maximum_linear / deceleration;
  return fmt::format(
      "{}; should driver and guardian both die at {:.1f} m/s, its watchdog of {} ms stops it after {:.1f} m", who,
      maximum_linear, robot.watchdog, distance);
}

std::string difference_from_file(const ConfigurationPacket& robot, const RobotDescription& file, bool settings_told) {
  const MotionLimits& limits = file.limits;
  if (1e-3 * robot.velocity_top < limits.linear) {
    return fmt::format("the robot's file allows {:.2f} m/s, the robot itself {:.2f} m/s", limits.linear,
                       1e-3 * robot.velocity_top);
  }
  constexpr double kRounding = 1.5;  // [mm/s^2]
  if (settings_told && std::abs(robot.deceleration - 1000.0 * limits.linear_deceleration) > kRounding) {
    return fmt::format("the robot brakes with {:.2f} m/s^2, its file says {:.2f} m/s^2", 1e-3 * robot.deceleration,
                       limits.linear_deceleration);
  }
  constexpr std::size_t kDiscsPerArray = 8;
  if (robot.has_rear_sonar == 0 && file.sonar.robot_from_sonar.size() > kDiscsPerArray) {
    return "the robot has no rear sonars, its file has some: they never echo";
  }
  return {};
}

}  // namespace luminav
