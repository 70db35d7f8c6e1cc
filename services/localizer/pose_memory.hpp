#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// The last pose held for true, and where odometry stood then.
struct RememberedPose {
  std::string building;      // its name
  int fixtures = 0;          // in its file: another number, another file
  std::int64_t session = 0;  // of ODOMETRY
  Pose2 odom_from_robot;
  PoseBelief belief;
};

/// Keeps the last pose in a file, written to a temporary one and renamed.
class PoseMemory {
 public:
  /// `folder` is made when needed; "" = remembers nothing.
  explicit PoseMemory(const std::filesystem::path& folder);

  /// Nothing when there is no file or it makes no sense.
  [[nodiscard]] std::optional<RememberedPose> load() const;
  /// False when it cannot be written.
  bool save(const RememberedPose& pose) const;
  void forget() const;

 private:
  std::filesystem::path file_;  // "" = off
};

/// The remembered pose carried to where odometry stands now; nothing when the session is another one, so that nobody
/// knows how the robot moved meanwhile, or when it drove so far that odometry alone does not tell enough.
std::optional<PoseBelief> carry_forward(const RememberedPose& remembered, std::int64_t session,
                                        const Pose2& odom_from_robot);

}  // namespace luminav
