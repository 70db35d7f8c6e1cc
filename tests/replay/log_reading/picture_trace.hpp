#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <luminav/camera_image_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/common/log/log_file.hpp"

namespace luminav {

/// Follows pictures through a log, from the middle of the exposure to the velocity command that used them: each stage
/// is over when the logger hears of it. True where camera and logger have one clock. Of pictures that one POSE uses
/// together the newest is followed.
class PictureTrace {
 public:
  /// When the driver had a picture [us]: known of a simulated camera only.
  using Arrival = std::function<std::int64_t(const camera_image_t&)>;
  explicit PictureTrace(Arrival arrival = {}) : arrival_(std::move(arrival)) {}

  void add(const LogEvent& event);

  /// One part of the path, over all pictures that came to its end.
  struct Stage {
    std::string name;
    std::vector<double> seconds;
    /// [s] of at least one.
    [[nodiscard]] double quantile(double share) const;
  };
  /// Those of which something was heard, in their order, then the sums: `image_to_detections`, `image_to_pose`,
  /// `image_to_command`, `arrival_to_command`.
  [[nodiscard]] std::vector<Stage> stages() const;
  /// The table with its head; "" when no picture was used.
  [[nodiscard]] std::string text() const;

 private:
  enum Mark { kTaken, kArrived, kPicture, kDetections, kPose, kCommand };
  static constexpr int kMarks = kCommand + 1;
  /// When [us] a picture passed each mark; 0 = not heard of.
  using Passage = std::array<std::int64_t, kMarks>;

  [[nodiscard]] Passage* nearest(std::int64_t utime);
  [[nodiscard]] Stage stage(const std::string& name, Mark from, Mark to) const;
  void hear_command(std::int64_t heard, const velocity_command_t& command);

  Arrival arrival_;
  std::map<std::int64_t, Passage> passages_;  // by the picture's stamp
  std::int64_t used_ = 0;                     // [us] newest fixture_utime of a POSE
  Passage* awaited_ = nullptr;                // whose command is to come
  std::optional<velocity_command_t> last_command_;
};

}  // namespace luminav
