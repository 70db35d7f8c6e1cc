#pragma once

#include <string>

#include "drivers/p3dx/line/arcos_link.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Why there is no session with the robot.
[[nodiscard]] std::string trouble_of(const ArcosLink& link);

/// The state of the line in one sentence. `maximum_linear` [m/s] and `deceleration` [m/s^2] tell how far the robot
/// would go on its watchdog alone.
[[nodiscard]] std::string describe_line(const ArcosLink& link, double maximum_linear, double deceleration);

/// What the robot says of itself and its file denies; "" = nothing that matters. How it brakes is compared only once
/// the robot has been told.
[[nodiscard]] std::string difference_from_file(const ConfigurationPacket& robot, const RobotDescription& file,
                                               bool settings_told);

}  // namespace luminav
