#pragma once

#include <luminav/control_status_t.hpp>
#include <luminav/path_t.hpp>
#include <optional>
#include <string>

#include "services/controller/controller.hpp"

namespace luminav {

/// The way that PATH tells; nothing, and why in one sentence, when its numbers are impossible.
std::optional<FollowedPath> path_of(const path_t& message, std::string& why);

/// What CONTROL_STATUS says of a control step, but for stamp, sequence and stop.
control_status_t status_of(const ControlOutput& output, const FollowedPath& path);

}  // namespace luminav
