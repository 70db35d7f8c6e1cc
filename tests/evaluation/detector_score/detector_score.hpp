#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "services/common/image/grey_image.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/model/detector_trace.hpp"
#include "tests/evaluation/detector_score/imaged_fixture.hpp"

namespace luminav::score {

/// Light and motion under which the detector is measured.
struct Condition {
  std::string name;
  bool lamps_on = false;      // belongs to "with lamps on"
  double min_daylight = 0.5;  // 0..1, drawn per frame
  double max_daylight = 0.5;
  double off = 0.0;         // share of the fixtures
  double half = 0.0;        // of which one of two tubes burns
  double flicker = 0.0;     // that go on and off some times a second
  double brightness = 1.0;  // factor on the exposure that the exposure control would settle at
  bool at_window = false;
  bool moving = false;  // up to 0.5 m/s and 30 deg/s, rolling shutter and motion blur
};

/// The lighting matrix.
const std::vector<Condition>& lighting_matrix();

struct DetectorScoreOptions {
  std::filesystem::path scenario;  // whose building and robot are taken; its lighting is not
  DetectorMode mode = DetectorMode::kModern;
  std::uint64_t first_seed = 1;  // 1000 and above are for measuring only
  int worlds = 2;                // one per seed: lamps, fixtures, lens and mounting are drawn anew
  int frames = 40;               // per world
  bool jpeg = true;              // quality 85, as on the network
  bool believed_camera = false;  // the detector knows the camera and ceiling of the files instead of the true ones, so
                                 // that errors of the mounting count (a tenth of an uncalibrated robot's)
};

/// Counts and sums over frames; the figures follow from them, so that scores of parts can be added.
struct DetectorScore {
  int frames = 0;
  int visible = 0;  // fixtures of which at least 30 % are in the image
  int seen = 0;     // of these, reported where they are
  int plain = 0;    // of the visible ones, those whose outline a person sees in this picture
  int plain_seen = 0;
  int whole = 0;  // entirely in the image
  int whole_seen = 0;
  int reported = 0;  // fixtures
  int wrong = 0;  // reported where there is none, or off by more than 30 mm across, 2 deg, or along 30 mm and 3.5 sigma
  int wrong_state = 0;      // lit, unlit or half taken for another; flickering ones don't count
  int cut_only_frames = 0;  // frames that show no whole fixture but at least one cut one
  int cut_used_frames = 0;  // of these, frames in which a fixture was reported where it is

  // Whole fixtures against their true image.
  int measured = 0;
  double centre_px2 = 0.0;  // [px^2]
  double worst_px = 0.0;
  double heading2 = 0.0;  // [rad^2]
  // Whole fixtures against the truth in the robot's frame when the row of their centre was exposed.
  double position2 = 0.0;       // [m^2]
  double robot_heading2 = 0.0;  // [rad^2]
  // Cut ones against their true image.
  int cut_measured = 0;
  double across2 = 0.0;       // [m^2] across the long side
  double cut_heading2 = 0.0;  // [rad^2]
  // Error squared by its covariance per degree of freedom.
  int normalised_count = 0;
  double normalised = 0.0;
  double normalised_along = 0.0;
  double normalised_across = 0.0;
  double normalised_heading = 0.0;

  double seconds = 0.0;  // of the thread's CPU time in the detector, JPEG decoding apart

  void add(const DetectorScore& other);
  [[nodiscard]] double precision() const;     // 1 when nothing was reported
  [[nodiscard]] double recall() const;        // over fixtures at least 30 % in the image
  [[nodiscard]] double plain_recall() const;  // over those that a person sees; 1 of none
  [[nodiscard]] double whole_recall() const;
  [[nodiscard]] double cut_use() const;  // share of the frames with only cut ones
  [[nodiscard]] double centre_rms_px() const;
  [[nodiscard]] double heading_rms_deg() const;
  [[nodiscard]] double position_rms_mm() const;
  [[nodiscard]] double robot_heading_rms_deg() const;
  [[nodiscard]] double cut_across_rms_mm() const;
  [[nodiscard]] double cut_heading_rms_deg() const;
  [[nodiscard]] double consistency() const;   // mean normalised error squared per degree of freedom
  [[nodiscard]] double milliseconds() const;  // per frame
};

/// A frame with what was found in it and what is to be said against that, for pictures of failures.
struct ScoredFrame {
  std::string name;
  const GreyImage* image = nullptr;
  std::vector<Detection> detections;
  std::vector<std::string> complaints;
  DetectorTrace trace;
};
using FrameListener = std::function<void(const ScoredFrame&)>;

/// Renders frames from random poses of a robot whose truth is drawn from the seed around the files (calibrated, as
/// DESIGN has it), detects, and compares with the truth. `listener` may be empty; it gets every frame.
DetectorScore score_detector(const DetectorScoreOptions& options, const Condition& condition,
                             const FrameListener& listener = {});

/// Title and one line of a table.
std::string score_table_header();
std::string score_table_row(const std::string& name, const DetectorScore& score);

}  // namespace luminav::score
