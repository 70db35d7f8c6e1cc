#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/surveyor/survey/ceiling_kinds.hpp"
#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {

/// A name that a person gave to the place where the robot was.
struct NamedMoment {
  std::string name;
  std::int64_t utime = 0;    // [us] of the last odometry before
  std::int64_t command = 0;  // id of the request
};

/// A survey drive and what its log had to say of itself.
struct SurveyLog {
  SurveyDrive drive;
  std::vector<NamedMoment> places;
  std::size_t images = 0;     // CAMERA_IMAGE messages
  std::size_t looked_at = 0;  // of these, by the detector
  double longest_gap = 0.0;   // [s] without ODOMETRY
  double blind_way = 0.0;     // [m] the longest way without an image
  bool is_cut = false;        // the log ends inside a message
  bool is_explored = false;   // the robot went everywhere that it could reach
};

/// What of a log to take the sightings from.
enum class SightingSource {
  kImagesElseDetections,  // images show lengths, and need no detector that knew the kinds while it drove
  kDetections             // what the detector made of them then; sooner done
};

/// Reads ODOMETRY, SONAR and the sightings of an LCM log. `robot_file` and `kinds` say what the detector has to know;
/// it looks at images a key frame apart. Throws std::runtime_error when there is no such file. Cost: 5 ms an image.
SurveyLog read_survey_log(const std::string& file, const std::string& robot_file, const CeilingKinds& kinds,
                          SightingSource source);

/// One drive of several, in this order; where the robot went in between nobody measured. A clock that began anew is put
/// behind the log before.
SurveyLog one_after_another(const std::vector<SurveyLog>& logs);

}  // namespace luminav
