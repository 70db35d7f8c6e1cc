#pragma once

#include <cstdint>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/pose_t.hpp>
#include <string>
#include <vector>

#include "services/caretaker/lamp_ledger.hpp"
#include "services/caretaker/visit_recorder.hpp"
#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/lamp_pictures.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// POSE and FIXTURE_DETECTIONS in; a ledger of the ceiling in a file out. It sends nothing: no other process needs it.
class CaretakerNode {
 public:
  /// `file` "" = keeps nothing. Throws std::runtime_error when the ledger is damaged.
  CaretakerNode(lcm::LCM& lcm, const RobotDescription& robot, const Building& building, std::filesystem::path file);

  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }
  [[nodiscard]] Health health() const;
  [[nodiscard]] const LampLedger& ledger() const { return ledger_; }
  /// Writes what ended since the last call.
  void save();
  /// Ends all visits and writes them, as at the end of a log.
  void finish();

 private:
  void on_pose(const pose_t& message);
  void on_fixture_detections(const fixture_detections_t& message);
  void keep_ended();

  std::vector<Fixture> fixtures_;
  std::int64_t time_offset_;  // [us] of the camera
  std::filesystem::path file_;
  VisitRecorder recorder_;
  LampPictures lamp_pictures_;
  LampLedger ledger_;
  bool is_changed_ = false;  // since it was written
  std::string fault_;        // why the last save failed; "" = it did not
  Subscriber subscriber_;    // last: handlers may run as soon as it exists
};

/// Where a robot's ledger of its ceiling lies.
std::filesystem::path ledger_file(const std::filesystem::path& state_folder, const std::string& robot);

}  // namespace luminav
