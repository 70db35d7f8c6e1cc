#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {

/// world_from_robot at the last odometry up to a time [us], carried by odometry from the nearest key frame; nothing
/// more than a metre's drive away from one, or where odometry began anew between: there the map does not reach.
/// `poses` are those of the frames.
std::optional<Pose2> pose_at(const std::vector<KeyFrame>& frames, const std::vector<Pose2>& poses,
                             const std::vector<OdometryReading>& odometry, std::int64_t utime);

}  // namespace luminav
