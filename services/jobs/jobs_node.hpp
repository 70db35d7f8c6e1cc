#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/process/event_loop.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/jobs/job_executor.hpp"
#include "services/jobs/jobs_config.hpp"
#include "services/jobs/speech/job_speech.hpp"
#include "services/jobs/storage/job_store.hpp"
#include "services/jobs/storage/photo_store.hpp"

namespace luminav {

/// JOB in, GOAL and JOB_STATUS out. ROBOT_STATUS is the tick; requests are taken without a robot, too. What was asked
/// lies on the disk before it is echoed, and what is to be driven before it is driven.
class JobsNode {
 public:
  /// With a key, commands without its seal are dropped, and its own are sealed. Throws ConfigurationError when the
  /// table of jobs is damaged.
  JobsNode(lcm::LCM& lcm, const JobsConfig& config, std::optional<CommandKey> key = {});

  /// The building's places are others now.
  void set_places(const std::vector<Place>& places) { executor_.set_places(places); }
  /// Home and stored tours are others now.
  void set_jobs(const JobsFile& jobs);
  /// What the robot is to say aloud now; "" = nothing. A voice belongs to `main`.
  std::string take_sentence() { return std::exchange(sentence_, ""); }
  /// The time of day where the robot is: a clock belongs to `main`.
  void tell_time(const LocalTime& now);
  /// The service is ended in order: the robot stands, and jobs that are left over ask before they go on.
  void end();
  [[nodiscard]] Health health() const;
  /// What it listens to: pictures only while one is to be kept.
  [[nodiscard]] std::vector<std::string> channels() const;
  [[nodiscard]] bool wants_pictures() const { return camera_.has_value(); }

 private:
  void on_job(const job_t& message);
  void on_navigation_status(const navigation_status_t& message);
  void on_pose(const pose_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_sonar(const sonar_t& message);
  void on_camera_image(const camera_image_t& message);

  /// Where the robot is, while it is known.
  [[nodiscard]] std::optional<Pose2> pose_at(std::int64_t utime) const;
  void go_on_or_ask(std::int64_t utime);
  void tick(const robot_status_t& status, double seconds);
  /// False when the disk takes nothing.
  bool keep();
  void listen_for_pictures();
  void publish_goal();
  void publish_speed_limit();
  void publish_status(std::int64_t utime);

  lcm::LCM& lcm_;
  JobsConfig config_;
  CommandPublisher commands_;
  JobExecutor executor_;
  JobStore store_;
  PhotoStore photos_;
  std::string photo_error_;
  StampGuard stamps_;
  JobCircumstances kept_;       // as the table has them; those of the process before until the robot is heard
  std::int64_t now_ = 0;        // [us] stamp of the last tick; 0 = nothing heard of the robot yet
  std::int64_t told_ = 0;       // [us] stamp of the last tick when the time of day was told last
  bool has_gone_on_ = false;    // with what the process before left over
  std::int64_t published_ = 0;  // [us] when JOB_STATUS was sent last
  std::int32_t sequence_ = 0;
  std::vector<std::uint8_t> last_status_;          // without its stamp
  std::optional<navigation_status_t> navigation_;  // since the last tick
  std::optional<pose_t> pose_;
  std::vector<Echo> echoes_;  // since the last tick
  std::string store_error_;
  std::optional<JobSpeech> speech_;   // while it is on
  std::string sentence_;              // that is due
  std::int64_t pictures_since_ = 0;   // [us] stamp since when it stands where one is to be kept
  std::optional<Subscriber> camera_;  // while one is
  Subscriber subscriber_;             // last: no handler may run on a half-built node
};

}  // namespace luminav
