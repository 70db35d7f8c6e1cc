#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <vector>

#include "drivers/camera/simulated/lighting.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/sensing/detector_behaviour.hpp"

namespace luminav {

/// One fixture in one frame of a rendered run.
struct SurveyedSighting {
  SightingClass sighting;
  std::size_t fixture = 0;
  std::int64_t frame = 0;
  int motion = 0;  // class of the motion since the frame before
  std::optional<MeasuredSighting> seen;
};

/// What the rendered detector did in one run.
struct SensingSurveyResult {
  std::int64_t frames = 0;
  std::int64_t false_frames = 0;  // with a false alarm
  std::int64_t false_begins = 0;  // false alarms that were not there in the frame before
  std::vector<SurveyedSighting> sightings;
  std::vector<MeasuredFalseAlarm> false_alarms;  // each where it began
};

/// Listens to a run with the rendered detector and notes, beside the truth, what it saw and how wrong that was.
class SensingSurvey {
 public:
  SensingSurvey(lcm::LCM& lcm, const WorldTruth& world, const Building& believed,
                const CameraDescription& believed_camera, std::uint64_t seed);

  [[nodiscard]] SensingSurveyResult& result() { return result_; }

 private:
  void on_truth(const sim_truth_t& truth);
  void on_detections(const fixture_detections_t& detections);
  void note_false_alarms(const fixture_detections_t& detections, const std::vector<bool>& matched, const Pose2& pose);

  WorldTruth world_;
  CeilingViewer viewer_;
  simulated::CeilingLight light_;
  double offset_;  // [us] from the stamp of detections to the truth
  simulated::TruthBuffer truth_;
  std::vector<FixtureView> views_;
  std::optional<Pose2> last_pose_;
  std::vector<Pose2> last_false_alarms_;  // world
  SensingSurveyResult result_;
  Subscriber subscriber_;
};

/// The table that geometric sensing draws from.
DetectorBehaviour fit_behaviour(const std::vector<SensingSurveyResult>& runs, const std::string& mode,
                                const std::string& source);

}  // namespace luminav
