#pragma once

#include <string>

namespace luminav {

/// How well runs with geometric sensing stand for rendered ones, over the runs (scenario and seed) that both have.
struct SensingAgreement {
  int runs = 0;
  double rendered_success = 0.0;  // 0..1 share of runs that passed
  double geometric_success = 0.0;
  double rendered_rms = 0.0;  // [m] in view, over all runs
  double geometric_rms = 0.0;
  double rendered_heading_rms = 0.0;  // [deg]
  double geometric_heading_rms = 0.0;
  double rendered_nees = 0.0;
  double geometric_nees = 0.0;

  /// Success and position error differ by at most a fifth.
  [[nodiscard]] bool agrees() const;
};

/// From two texts of `evaluate --json`. Throws std::runtime_error for text that is no report.
SensingAgreement compare_sensings(const std::string& rendered_json, const std::string& geometric_json);

/// Two or three sentences for people.
std::string to_text(const SensingAgreement& agreement);

}  // namespace luminav
