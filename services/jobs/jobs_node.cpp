#include "services/jobs/jobs_node.hpp"

#include <algorithm>
#include <luminav/speed_limit_t.hpp>
#include <utility>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/jobs/job_messages.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kTick = 190'000;  // [us] requests are repeated at 5 Hz
constexpr double kLongestStep = 1.0;     // [s] a clock that jumps is no time that passes
static_assert(JobQueue::kMaxEchoes == job_status_t::MAX_ECHOES && JobQueue::kMaxAge == job_status_t::MAX_AGE);
constexpr int kFarewells = 3;  // cancellations at the end, of which one arrives

}  // namespace

JobsNode::JobsNode(lcm::LCM& lcm, const JobsConfig& config, std::optional<CommandKey> key)
    : commands_(lcm, key),
      executor_(config.params, config.site),
      inputs_(config.robot.sonar),
      keeper_(config, executor_),
      photographer_(lcm, config.state_folder.empty() ? std::filesystem::path() : config.state_folder / "photos",
                    executor_, inputs_),
      status_(lcm),
      subscriber_(lcm, key) {
  if (config.speech != "off") {
    speech_.emplace(config.speech == "de" ? SpeechLanguage::kGerman : SpeechLanguage::kEnglish);
  }
  subscriber_.on(channels::kJob, &JobsNode::on_job, this);
  subscriber_.on(channels::kNavigationStatus, &JobsNode::on_navigation_status, this);
  subscriber_.on(channels::kPose, &JobsNode::on_pose, this);
  subscriber_.on(channels::kRobotStatus, &JobsNode::on_robot_status, this);
  subscriber_.on(channels::kSonar, &JobsNode::on_sonar, this);
}

Health JobsNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  health.reason = keeper_.error().empty() ? photographer_.error() : keeper_.error();
  health.degraded = !health.reason.empty();
  return health;
}

void JobsNode::on_job(const job_t& message) {
  const std::optional<JobRequest> request = request_from(message);
  if (!request) {
    subscriber_.drop("JOB with a number that stands for nothing");
    return;
  }
  const std::int64_t utime = now_ != 0 ? now_ : message.utime;
  executor_.take(*request, utime);
  if (!keeper_.keep() && request->action == JobRequest::Action::kAdd) {
    executor_.withdraw(request->id, "it cannot be kept: " + keeper_.error());
  }
  publish_goal();  // a cancellation does not wait
  status_.publish(executor_, utime);
}

void JobsNode::on_pose(const pose_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("POSE: impossible");
    return;
  }
  inputs_.take(message);
}

std::vector<std::string> JobsNode::channels() const {
  std::vector<std::string> channels = subscriber_.channels();
  if (wants_pictures()) {
    channels.emplace_back(channels::kCameraImage);
  }
  return channels;
}

void JobsNode::on_robot_status(const robot_status_t& message) {
  const StampGuard::Verdict verdict = stamps_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    return;
  }
  const bool is_first = now_ == 0 || verdict == StampGuard::Verdict::kNewSession;
  if (!is_first && message.utime - now_ < kTick) {
    return;
  }
  const double seconds = is_first ? 0.0 : std::min(seconds_between(now_, message.utime), kLongestStep);
  now_ = message.utime;
  tick(message, seconds);
}

void JobsNode::tick(const robot_status_t& status, double seconds) {
  keeper_.tick(now_);
  executor_.update(inputs_.moment(status, seconds));
  if (std::optional<std::string> sentence = speech_ ? speech_->next(executor_) : std::nullopt) {
    sentence_ = std::move(*sentence);
  }
  photographer_.tick(now_);
  keeper_.keep();
  publish_goal();
  publish_speed_limit();
  status_.publish(executor_, now_);
}

void JobsNode::set_jobs(const JobsFile& jobs) {
  executor_.set_jobs(jobs);
  status_.publish(executor_, stamp());
}

void JobsNode::tell_time(const LocalTime& now) {
  if (now_ != told_) {  // a robot that is silent misses its tours
    executor_.tell_time(now, now_);
    keeper_.keep();
  } else {  // no tick since: the robot is silent, people ask all the same
    status_.repeat(executor_, stamp());
  }
  told_ = now_;
}

void JobsNode::end() {
  if (const std::optional<DriveRequest> request = executor_.end()) {
    for (int i = 0; i < kFarewells; ++i) {
      commands_.publish(channels::kGoal, goal_from(*request, now_));
    }
  }
  keeper_.end();
}

void JobsNode::publish_goal() {
  if (const std::optional<DriveRequest> request = executor_.goal(); request && now_ != 0) {
    commands_.publish(channels::kGoal, goal_from(*request, now_));
  }
}

void JobsNode::publish_speed_limit() {
  if (const std::optional<double> max_speed = executor_.speed_limit()) {
    speed_limit_t limit{};
    limit.utime = now_;
    limit.max_speed = *max_speed;
    limit.sender = "jobs";
    commands_.publish(channels::kSpeedLimit, limit);
  }
}

}  // namespace luminav
