#pragma once

#include <algorithm>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
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
#include "services/jobs/job_inputs.hpp"
#include "services/jobs/job_status_publisher.hpp"
#include "services/jobs/jobs_config.hpp"
#include "services/jobs/speech/job_speech.hpp"
#include "services/jobs/storage/job_keeper.hpp"
#include "services/jobs/storage/photographer.hpp"

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
  [[nodiscard]] bool wants_pictures() const { return photographer_.is_listening(); }

 private:
  void on_job(const job_t& message);
  void on_navigation_status(const navigation_status_t& message) { inputs_.take(message); }
  void on_pose(const pose_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_sonar(const sonar_t& message) { inputs_.take(message); }

  void tick(const robot_status_t& status, double seconds);
  void publish_goal();
  void publish_speed_limit();
  /// [us] of the last tick; never 0, which is no stamp.
  [[nodiscard]] std::int64_t stamp() const { return std::max<std::int64_t>(now_, 1); }

  CommandPublisher commands_;
  JobExecutor executor_;
  JobInputs inputs_;
  JobKeeper keeper_;
  Photographer photographer_;
  JobStatusPublisher status_;
  StampGuard stamps_;
  std::int64_t now_ = 0;             // [us] stamp of the last tick; 0 = nothing heard of the robot yet
  std::int64_t told_ = 0;            // [us] stamp of the last tick when the time of day was told last
  std::optional<JobSpeech> speech_;  // while it is on
  std::string sentence_;             // that is due
  Subscriber subscriber_;            // last: no handler may run on a half-built node
};

}  // namespace luminav
