#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "services/common/building/building.hpp"
#include "services/common/ceiling/fixture_sighting.hpp"
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

/// Keeps the last pose in a file, written to a temporary one and renamed, for as long as it is held for true.
class PoseMemory {
 public:
  /// `folder` is made when needed; "" = remembers nothing.
  PoseMemory(const std::filesystem::path& folder, const Building& building);

  /// Once, with the first odometry: the pose of an earlier run carried to there, if it is of this building.
  [[nodiscard]] std::optional<PoseBelief> recall(const OdometryReading& odometry);
  /// Writes a TRACKING pose once a second; forgets it when it has been in doubt for five.
  void remember(const OdometryReading& odometry, const LocalizerEstimate& estimate);
  /// The stream of odometry began anew: what is remembered belongs to the old one.
  void restart();
  /// The last pose could not be written.
  [[nodiscard]] bool has_failed() const { return has_failed_; }

  /// Nothing when there is no file or it makes no sense.
  [[nodiscard]] std::optional<RememberedPose> load() const;
  /// False when it cannot be written.
  bool save(const RememberedPose& pose) const;

 private:
  void forget();

  std::filesystem::path file_;  // "" = off
  std::string building_;        // its name
  int fixtures_;                // in its file
  bool is_recalled_ = false;    // the file was looked at
  bool is_remembered_ = false;  // the file holds a pose
  bool has_failed_ = false;
  std::int64_t saved_utime_ = 0;  // [us] of the pose written last
};

}  // namespace luminav
