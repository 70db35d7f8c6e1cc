#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/survey_command_t.hpp>
#include <luminav/survey_status_t.hpp>
#include <luminav/tile_request_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/log/log_appender.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/surveyor/drive/drive_collector.hpp"
#include "services/surveyor/explore/exploration.hpp"
#include "services/surveyor/live/ground_publisher.hpp"
#include "services/surveyor/live/live_ground.hpp"
#include "services/surveyor/live/live_survey.hpp"
#include "services/surveyor/live/survey_work.hpp"
#include "services/surveyor/live/surveyor_config.hpp"

namespace luminav {

/// ODOMETRY, SONAR, CAMERA_IMAGE and SURVEY_COMMAND in, SURVEY_STATUS, POSE and GRID_TILE out; while it explores
/// NAVIGATION_STATUS in and GOAL out. What it uses of the drive lies in the survey's log before it is used: begun again
/// with the same folder, it goes on where it was.
class SurveyorNode {
 public:
  /// Reads what the folder's log has: 1 ms an image. With a key, commands without its seal are dropped. Throws
  /// std::runtime_error where the log cannot be read or written.
  SurveyorNode(lcm::LCM& lcm, const SurveyorConfig& config, std::optional<CommandKey> key = {});

  /// Takes over what was estimated or written since the last call, and begins what is to be done next.
  void take_results();
  /// Waits until nothing is being estimated or written, and takes it over.
  void settle();

  /// Explores as soon as the robot is heard, unless the log says who drove last.
  void explore_at_once() { driving_.is_wanted = driving_.is_wanted || !driving_.is_told; }
  [[nodiscard]] bool is_finished() const { return is_finished_; }

  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }
  [[nodiscard]] Health health() const;

 private:
  /// What the robot does by itself.
  struct Driving {
    Exploration exploration;
    bool is_wanted = false;   // as soon as the robot is heard
    bool is_resumed = false;  // it was exploring when the surveyor ended
    bool is_told = false;     // the log says who drove last,
    bool is_noted = false;    // and that it is the robot
    bool is_allowed = false;  // no stop is engaged, and the motors are on
    std::int64_t asked = 0;   // [us] now_ when GOAL was sent last
  };
  void on_odometry(const odometry_t& message);
  void on_sonar(const sonar_t& message);
  void on_camera_image(const camera_image_t& message);
  void on_fixture_detections(const fixture_detections_t& message);
  void on_survey_command(const survey_command_t& message);
  void on_navigation_status(const navigation_status_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_tile_request(const tile_request_t& message);

  /// False while the building is being written and once it is: its log is what it was made of.
  [[nodiscard]] bool is_recording() const { return !wants_end_ && !is_finished_; }
  /// Appends to the log what told something.
  template <typename Message>
  void record(const char* channel, const Message& message);
  void explore();
  /// Takes a message of the log.
  void read(const LogEvent& event);
  /// Writes into the log who drives, if that has changed: a surveyor that is started again goes on.
  void note_who_drives();
  /// Keeps what was tried for a surveyor that is started again.
  void keep_tried_floor();
  /// Writes into the log that nothing is left to explore: then the building has no lamp that is not listed.
  void note_explored();
  void publish_goal();
  /// Why a command is not obeyed; "" = it is.
  std::string obey(const survey_command_t& command);
  void take(SurveyWork::Result result);
  void publish();
  [[nodiscard]] std::int8_t state() const;
  [[nodiscard]] std::string reason() const;

  lcm::LCM& lcm_;
  SurveyorConfig config_;
  DriveCollector collector_;
  LiveSurvey live_;
  std::optional<LogAppender> log_;
  LiveGround ground_;
  GroundPublisher ground_publisher_;
  CommandPublisher commands_;
  Driving driving_;
  SurveyWork work_;
  std::int64_t now_ = 1;        // [us] stamp of the newest ODOMETRY, or of a command before there was one
  std::int64_t published_ = 0;  // [us] now_ when SURVEY_STATUS was sent last
  std::int32_t sequence_ = 0;
  std::int64_t echo_id_ = 0;  // of the last command
  std::string objection_;     // to it
  bool wants_end_ = false;    // somebody said finish, and it is not written yet
  bool is_finished_ = false;
  std::string failure_;      // FAILED, and why
  std::string no_estimate_;  // why the last estimate came to nothing: more may come of a longer drive
  Subscriber subscriber_;    // last: no handler may run on a half-built node
};

}  // namespace luminav
