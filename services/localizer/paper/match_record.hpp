#pragma once

#include <cstdint>

#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// When a fixture was matched last, how far the robot has come since, and how well matches agree with the prediction.
class MatchRecord {
 public:
  /// `gain` is a match's share in the running mean of the normalised innovations.
  explicit MatchRecord(double gain) : gain_(gain) {}

  void travel(double distance) { odometer_ += distance; }
  /// The image of that time [us] was used.
  void note_image(std::int64_t utime) {
    utime_ = utime;
    odometer_at_image_ = odometer_;
  }
  /// Normalised innovation squared of one match, which has three degrees of freedom.
  void add_nis(double nis) {
    nis_ = has_nis_ ? nis_ + gain_ * (nis / 3.0 - nis_) : nis / 3.0;
    has_nis_ = true;
  }
  /// What follows is another pose: its mean begins anew.
  void restart_nis() { has_nis_ = false; }

  /// [m] since the last image used, or since the beginning.
  [[nodiscard]] double distance_since() const { return odometer_ - odometer_at_image_; }
  void write_to(LocalizerEstimate& estimate) const {
    estimate.fixture_utime = utime_;
    estimate.distance_since_fixture = distance_since();
    estimate.has_nis = has_nis_;
    estimate.nis = nis_;
  }

 private:
  double gain_;
  double odometer_ = 0.0;  // [m]
  double odometer_at_image_ = 0.0;
  std::int64_t utime_ = 0;
  double nis_ = 0.0;
  bool has_nis_ = false;
};

}  // namespace luminav
