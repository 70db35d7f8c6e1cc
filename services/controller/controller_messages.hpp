#pragma once

#include <luminav/control_status_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <luminav/path_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/controller/controller.hpp"

namespace luminav {

/// The path in PATH; nothing, and why in one sentence, when its numbers are impossible.
std::optional<FollowedPath> path_of(const path_t& message, std::string& why);

/// The poses that HYPOTHESES lists, told of a robot at `odom_from_robot`; nothing, and why, when its numbers are
/// impossible.
std::optional<std::vector<PoseAlternative>> alternatives_of(const hypotheses_t& message, const Pose2& odom_from_robot,
                                                            std::string& why);

/// What CONTROL_STATUS says of a control step, but for stamp, sequence and stop.
control_status_t status_of(const ControlOutput& output, const FollowedPath& path);

}  // namespace luminav
