#include "services/jobs/jobs_node.hpp"

#include <algorithm>
#include <cmath>
#include <luminav/speed_limit_t.hpp>
#include <utility>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/jobs/job_messages.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kTick = 190'000;           // [us] requests are repeated at 5 Hz
constexpr std::int64_t kStatusPeriod = 950'000;   // [us] JOB_STATUS is repeated: a datagram may get lost
constexpr std::int64_t kKeepPeriod = 20'000'000;  // [us] the table is kept anew: how long ago tells whether it goes on
constexpr double kLongestStep = 1.0;              // [s] a clock that jumps is no time that passes
constexpr std::int64_t kPoseAge = 1'000'000;      // [us] an older pose does not count
static_assert(JobQueue::kMaxEchoes == job_status_t::MAX_ECHOES && JobQueue::kMaxAge == job_status_t::MAX_AGE);
constexpr std::size_t kMaxEchoes = 100;  // without a tick
constexpr int kFarewells = 3;            // cancellations at the end, of which one arrives

}  // namespace

JobsNode::JobsNode(lcm::LCM& lcm, const JobsConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      commands_(lcm, key),
      executor_(config.params, config.site),
      store_(config.state_folder),
      photos_(config.state_folder.empty() ? std::filesystem::path() : config.state_folder / "photos"),
      kept_{config.boot, config.site.building},
      subscriber_(lcm, key) {
  if (config.speech != "off") {
    speech_.emplace(config.speech == "de" ? SpeechLanguage::kGerman : SpeechLanguage::kEnglish);
  }
  if (std::optional<StoredJobs> stored = store_.recall()) {
    executor_.load(std::move(stored->table));
    kept_ = stored->kept;
  } else {
    has_gone_on_ = true;
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
  health.degraded = !store_error_.empty() || !photo_error_.empty();
  health.reason = store_error_.empty() ? photo_error_ : store_error_;
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
  if (!keep() && request->action == JobRequest::Action::kAdd) {
    executor_.withdraw(request->id, "it cannot be kept: " + store_error_);
  }
  publish_goal();  // a cancellation does not wait
  publish_status(utime);
}

void JobsNode::on_navigation_status(const navigation_status_t& message) {
  navigation_ = message;
}

void JobsNode::on_pose(const pose_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("POSE: impossible");
    return;
  }
  pose_ = message;
}

void JobsNode::on_sonar(const sonar_t& message) {
  const SonarRing& ring = config_.robot.sonar;
  const std::optional<Pose2> robot = pose_at(message.utime);
  if (!robot || echoes_.size() > kMaxEchoes) {
    return;
  }
  const std::size_t discs = std::min(ring.robot_from_sonar.size(), message.range.size());
  for (std::size_t disc = 0; disc < discs; ++disc) {
    if (message.fresh.at(disc) != 0 && message.has_echo.at(disc) != 0) {
      echoes_.push_back(
          {*robot * ring.robot_from_sonar[disc], ring.half_angle, static_cast<double>(message.range[disc])});
    }
  }
}

std::vector<std::string> JobsNode::channels() const {
  std::vector<std::string> channels = subscriber_.channels();
  if (camera_) {
    channels.emplace_back(channels::kCameraImage);
  }
  return channels;
}

// Fifteen pictures a second are nobody's business here but where one is to be kept.
void JobsNode::listen_for_pictures() {
  const bool wants = executor_.wanted_photo().has_value();
  if (wants && !camera_) {
    pictures_since_ = now_;
    camera_.emplace(lcm_);
    camera_->on(channels::kCameraImage, &JobsNode::on_camera_image, this);
  } else if (!wants) {
    camera_.reset();
  }
}

void JobsNode::on_camera_image(const camera_image_t& message) {
  const std::optional<PhotoWish> wish = executor_.wanted_photo();
  if (!wish || message.utime < pictures_since_) {
    return;  // one that was taken on the way
  }
  try {
    photos_.keep(message, *wish, pose_at(message.utime));
    photo_error_.clear();
  } catch (const std::exception& error) {
    photo_error_ = error.what();
  }
  executor_.end_photo();
}

std::optional<Pose2> JobsNode::pose_at(std::int64_t utime) const {
  const bool is_known = pose_ && pose_->state == pose_t::STATE_TRACKING && std::abs(utime - pose_->utime) < kPoseAge;
  return is_known ? std::optional(world_from_robot(*pose_)) : std::nullopt;
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
  if (!has_gone_on_) {
    go_on_or_ask(now_);
  }
  tick(message, seconds);
}

void JobsNode::go_on_or_ask(std::int64_t utime) {
  has_gone_on_ = true;
  if (const std::string why = objection_to_going_on(kept_, {config_.boot, config_.site.building, utime});
      !why.empty()) {
    executor_.ask_for_left_over(why);
  }
  kept_ = {config_.boot, config_.site.building, utime};
}

void JobsNode::tick(const robot_status_t& status, double seconds) {
  JobMoment moment;
  moment.utime = now_;
  moment.seconds = seconds;
  if (navigation_) {
    moment.navigation = navigation_from(*navigation_);
    navigation_.reset();
  }
  moment.world_from_robot = pose_at(now_);
  moment.handled = who_handles(status);
  moment.voltage = status.battery_voltage;
  moment.charger = status.charge_state > robot_status_t::CHARGE_BULK   ? Charger::kHasCharged
                   : status.charge_state > robot_status_t::CHARGE_NONE ? Charger::kCharges
                                                                       : Charger::kNotHeard;
  moment.driven = std::max(0.0, status.linear) * seconds;
  moment.echoes = std::exchange(echoes_, {});
  executor_.update(moment);
  if (std::optional<std::string> sentence = speech_ ? speech_->next(executor_) : std::nullopt) {
    sentence_ = std::move(*sentence);
  }
  if (now_ - kept_.utime > kKeepPeriod || now_ < kept_.utime) {
    kept_.utime = now_;
  }
  listen_for_pictures();
  keep();
  publish_goal();
  publish_speed_limit();
  publish_status(now_);
}

void JobsNode::set_jobs(const JobsFile& jobs) {
  executor_.set_jobs(jobs);
  publish_status(std::max<std::int64_t>(now_, 1));
}

void JobsNode::tell_time(const LocalTime& now) {
  if (now_ != told_) {  // a robot that is silent misses its tours
    executor_.tell_time(now, now_);
    keep();
  } else {  // no tick since: the robot is silent, people ask all the same
    last_status_.clear();
    publish_status(std::max<std::int64_t>(now_, 1));
  }
  told_ = now_;
}

bool JobsNode::keep() {
  try {
    store_.keep({executor_.table(), kept_});
    store_error_.clear();
  } catch (const std::exception& error) {
    store_error_ = error.what();
  }
  return store_error_.empty();
}

void JobsNode::end() {
  if (const std::optional<DriveRequest> request = executor_.end()) {
    for (int i = 0; i < kFarewells; ++i) {
      commands_.publish(channels::kGoal, goal_from(*request, now_));
    }
  }
  kept_.ended = true;
  keep();
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

void JobsNode::publish_status(std::int64_t utime) {
  job_status_t status = status_from(executor_);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(status.getEncodedSize()));
  status.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  if (bytes == last_status_ && utime >= published_ && utime - published_ < kStatusPeriod) {
    return;
  }
  last_status_ = std::move(bytes);
  published_ = utime;
  status.utime = utime;
  status.sequence = ++sequence_;
  lcm_.publish(channels::kJobStatus, &status);
}

}  // namespace luminav
