#include "tests/unit/recorded_ceiling/recorded_survey.hpp"

#include <cmath>

#include "services/surveyor/drive/survey_writing.hpp"
#include "tests/unit/recorded_ceiling/recorded_run.hpp"
#include "tests/unit/recorded_ceiling/visual_odometry.hpp"

namespace luminav::testing {
namespace {

/// Sums up of a drive what its increments are off by, for a survey that knows it by the metre.
class IncrementErrors {
 public:
  void add(const Pose2& step, const Eigen::Matrix3d& covariance, double wheel_base) {
    distance_ += noise_distance(step, wheel_base);
    position_ += 0.5 * covariance.topLeftCorner<2, 2>().trace();
    heading_ += covariance(2, 2);
  }
  void put_into(ErrorParams& errors) const {
    errors.odometry_position = std::sqrt(position_ / distance_);
    errors.odometry_heading = std::sqrt(heading_ / distance_);
  }

 private:
  double distance_ = 0.0;  // [m]
  double position_ = 0.0;  // [m^2]
  double heading_ = 0.0;   // [rad^2]
};

}  // namespace

RecordedSurvey survey_recording(const std::string& robot) {
  const RecordedRun run = read_recorded_run(DetectorMode::kModern, robot);
  RecordedSurvey result;
  result.model = read_survey_model(recording_folder() / robot, recording_folder() / "fisheye-kinds.toml");
  SurveyDrive drive;  // without lengths: of what shines nobody measured any
  VisualOdometry odometry;
  IncrementErrors errors;
  Pose2 before;
  for (const RecordedRun::Frame& frame : run.frames) {
    const Pose2 pose = odometry.step(frame.seen.sightings);
    if (!drive.frames.empty()) {
      errors.add(before.inverse() * pose, odometry.covariance(), result.model.robot.wheel_base);
    }
    drive.odometry.push_back({frame.seen.utime, 1, pose});
    drive.frames.push_back(frame.seen);
    before = pose;
  }
  errors.put_into(result.model.errors);
  result.survey = survey_drive(drive, result.model);
  std::vector<Pose2> bars;
  for (const SurveyedFixture& fixture : result.survey.estimate.fixtures) {
    bars.push_back(fixture.world_from_fixture);
  }
  result.grid = fit_light_grid(bars);
  return result;
}

}  // namespace luminav::testing
