#pragma once

#include <luminav/camera_image_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/survey_command_t.hpp>
#include <memory>
#include <string_view>

#include "services/detector/detector_config.hpp"
#include "services/surveyor/drive/survey_log.hpp"

namespace luminav {

inline constexpr const char* kExplored = "explored";

/// Collects a survey drive from its messages, in the order of a log or as they come: the same messages make the same
/// drive. Each `add` says whether the message told something; a log without those that did not makes the same drive.
class DriveCollector {
 public:
  /// Takes the sightings from FIXTURE_DETECTIONS.
  DriveCollector();
  /// Takes the sightings from images a key frame apart. Cost: 5 ms for each of these.
  explicit DriveCollector(const DetectorConfig& config);
  ~DriveCollector();

  bool add(const odometry_t& message);
  bool add(const sonar_t& message);
  bool add(const camera_image_t& message);
  bool add(const fixture_detections_t& message);
  /// Where a localizer was sure to be: it says how the drive lies in a building that is known.
  bool add(const pose_t& message);
  /// A place that a person names is where the last odometry was; a FINISH called kExplored says that nothing was left
  /// to explore.
  bool add(const survey_command_t& message);
  /// A message of a log; of other channels none tells something.
  bool add(std::string_view channel, const void* data, std::size_t size);

  /// What came so far, in the order it came, gaps not measured.
  [[nodiscard]] const SurveyLog& so_far() const { return log_; }
  /// What came so far, in order and with its gaps measured.
  [[nodiscard]] SurveyLog collected() const;

 private:
  class ImageReader;
  template <typename Message>
  bool add_bytes(const void* data, std::size_t size);

  std::unique_ptr<ImageReader> reader_;
  SurveyLog log_;
};

}  // namespace luminav
