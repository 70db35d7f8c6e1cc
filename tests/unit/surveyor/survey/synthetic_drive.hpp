#pragma once

#include <cstdint>
#include <vector>

#include "services/surveyor/survey/key_frames.hpp"
#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// What is wrong with the robot of a synthetic drive, and how noisy its senses are.
struct SyntheticErrors {
  WheelCorrection wheels;          // what they ought to be corrected by
  double odometry_position = 0.0;  // [m per sqrt m]
  double odometry_heading = 0.0;   // [rad per sqrt m]
  double sighting_position = 0.0;  // [m]
  double sighting_heading = 0.0;   // [rad]
  double camera_scale = 0.0;       // fraction by which the ceiling's picture is too large
  double bloom = -1.0;       // [m] by which an end looks too far out; negative: who shows one end alone is not seen
  double false_share = 0.0;  // images with a fixture in them that is none
  std::uint32_t seed = 1;
};

/// A robot that drives along corners of a path, turning on the spot, below fixtures: without clock, messages or walls.
struct SyntheticDrive {
  SurveyDrive drive;
  std::vector<Pose2> truth;  // world_from_robot at each frame
};

/// Drives at 0.4 m/s along `corners` [m]. Fixtures wholly in view of the model's camera are seen, and with bloom those
/// of which one end is.
SyntheticDrive drive_along(const std::vector<Eigen::Vector2d>& corners, const std::vector<Fixture>& fixtures,
                           const SurveyModel& model, const SyntheticErrors& errors);

/// The shipped robot, with a camera that reads all rows at once, below a ceiling of 2.8 m with fixtures of 1.2 m x 0.3
/// m.
SurveyModel synthetic_model();

/// A fixture of that kind.
Fixture fixture_at(int id, double x, double y, double theta);

/// RMS distance [m] between each true fixture and the surveyed one nearest to it, after the rigid motion that fits them
/// best; `start` is the true pose where the survey's first pose is, which says roughly where its map lies.
double rms_after_alignment(const std::vector<Fixture>& truth, const SurveyEstimate& estimate, const Pose2& start);

}  // namespace luminav
