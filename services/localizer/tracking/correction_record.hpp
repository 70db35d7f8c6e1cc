#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// When and where fixtures last corrected the filter, and whether it is as sure as it may be: the running mean of the
/// normalised innovation squared (NIS) per degree of freedom is then 1. Bar-Shalom et al. 2001, section 5.4.
class CorrectionRecord {
 public:
  /// The image of this time [us], taken where the odometer stood [m], and the NIS of each fixture matched in it.
  void add(std::int64_t utime, double odometer, const std::vector<double>& nis) {
    for (const double value : nis) {
      mean_nis_ = mean_nis_ ? *mean_nis_ + kShare * (value / 3.0 - *mean_nis_) : value / 3.0;
    }
    if (!nis.empty()) {
      note(utime, odometer);
    }
  }
  /// The image of this time was used otherwise.
  void note(std::int64_t utime, double odometer) {
    utime_ = utime;
    odometer_ = odometer;
  }

  /// [us] of the last image used; 0 = none yet.
  [[nodiscard]] std::int64_t utime() const { return utime_; }
  /// [m] driven since.
  [[nodiscard]] double distance_since(double odometer) const { return odometer - odometer_; }
  [[nodiscard]] std::optional<double> mean_nis() const { return mean_nis_; }
  void write_to(LocalizerEstimate& estimate, double odometer) const {
    estimate.fixture_utime = utime_;
    estimate.distance_since_fixture = distance_since(odometer);
    estimate.nis = mean_nis_;
  }

 private:
  static constexpr double kShare = 0.02;  // of the newest

  std::int64_t utime_ = 0;  // [us]
  double odometer_ = 0.0;   // [m]
  std::optional<double> mean_nis_;
};

}  // namespace luminav
