#pragma once

#include <optional>

namespace luminav {

struct FollowerParams {
  double reach = 2.5;       // [m] within which somebody behind the robot follows it
  double step = 0.3;        // [m] of driving after which an echo is judged
  double lost_after = 2.0;  // [m] of driving without anybody behind, then he is lost
  double approach = 0.4;    // [m] that an echo must come nearer to a robot that stands
};

/// Whether somebody follows, by what the sonars hear straight behind. What stands falls back as the robot drives on;
/// what keeps its distance follows. A robot that waits is found again by whom it hears coming nearer.
class FollowerWatch {
 public:
  explicit FollowerWatch(const FollowerParams& params) : params_(params) {}

  /// Somebody stands behind it and is about to follow.
  void begin() { *this = FollowerWatch(params_); }
  /// The robot stands from now on, and waits for him.
  void wait() { anchor_.reset(); }

  /// `range` [m] of the nearest echo behind, nothing = none; `driven` [m] forward since the last time.
  void update(std::optional<double> range, double driven) {
    driven_ += driven;
    unseen_ += driven;
    if (!range || *range > params_.reach) {
      anchor_.reset();
      driven_ = 0.0;
      return;
    }
    if (!anchor_) {
      anchor_ = range;
      driven_ = 0.0;
    }
    const double fell_back = *range - *anchor_;
    if (driven_ >= params_.step ? fell_back < 0.5 * driven_ : fell_back < -params_.approach) {
      unseen_ = 0.0;
    }
    if (driven_ >= params_.step || unseen_ == 0.0) {
      anchor_ = range;
      driven_ = 0.0;
    }
  }

  /// The person himself says that he is there.
  void see() { unseen_ = 0.0; }
  [[nodiscard]] bool is_lost() const { return unseen_ > params_.lost_after; }
  /// He was seen within the last steps.
  [[nodiscard]] bool is_near() const { return unseen_ <= params_.step; }

 private:
  FollowerParams params_;
  std::optional<double> anchor_;  // [m] echo when the present step began
  double driven_ = 0.0;           // [m] since then
  double unseen_ = 0.0;           // [m] driven since he was seen last
};

}  // namespace luminav
