#include "services/surveyor/live/surveyor_node.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"
#include "services/surveyor/live/survey_messages.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // [us] of SURVEY_STATUS, and of what a power loss may cost
constexpr std::int64_t kRepeat = 200'000;    // [us] of a GOAL until it is echoed
constexpr std::size_t kLongestName = 60;     // [bytes] of a place

bool is_name(const std::string& name) {
  const auto is_control = [](char letter) { return static_cast<unsigned char>(letter) < ' ' || letter == 0x7F; };
  return !name.empty() && name.size() <= kLongestName && std::none_of(name.begin(), name.end(), is_control);
}

}  // namespace

SurveyorNode::SurveyorNode(lcm::LCM& lcm, const SurveyorConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      collector_(config.source == SightingSource::kDetections ? DriveCollector() : DriveCollector(config.detector)),
      live_(config.model),
      ground_(config.model),
      ground_publisher_(lcm),
      commands_(lcm, key),
      driving_{Exploration(config.exploration)},
      is_finished_(std::filesystem::exists(config.folder / "building.toml")),
      subscriber_(lcm, key) {
  subscriber_.on<odometry_t>(channels::kOdometry, &SurveyorNode::on_odometry, this);
  subscriber_.on<sonar_t>(channels::kSonar, &SurveyorNode::on_sonar, this);
  subscriber_.on<camera_image_t>(channels::kCameraImage, &SurveyorNode::on_camera_image, this);
  subscriber_.on<fixture_detections_t>(channels::kFixtureDetections, &SurveyorNode::on_fixture_detections, this);
  subscriber_.on<survey_command_t>(channels::kSurveyCommand, &SurveyorNode::on_survey_command, this);
  subscriber_.on<navigation_status_t>(channels::kNavigationStatus, &SurveyorNode::on_navigation_status, this);
  subscriber_.on<robot_status_t>(channels::kRobotStatus, &SurveyorNode::on_robot_status, this);
  subscriber_.on<tile_request_t>(channels::kTileRequest, &SurveyorNode::on_tile_request, this);
  // not before: what is sent while a long log is read waits in LCM's queues, and leaves no gap
  log_.emplace(config.log_file(), [this](const LogEvent& event) { read(event); });
  for (const OdometryReading& reading : collector_.so_far().drive.odometry) {
    live_.add(reading);
    ground_.add(reading);
    now_ = reading.utime;
  }
  ground_.redraw(collector_.so_far());
  take_results();
}

void SurveyorNode::read(const LogEvent& event) {
  collector_.add(event.channel, event.data.data(), event.data.size());
  survey_command_t command{};
  if (event.channel == channels::kSurveyCommand &&
      command.decode(event.data.data(), 0, static_cast<int>(event.data.size())) > 0 &&
      (command.action == survey_command_t::ACTION_EXPLORE || command.action == survey_command_t::ACTION_STAY)) {
    driving_.is_told = true;
    driving_.is_noted = driving_.is_wanted = command.action == survey_command_t::ACTION_EXPLORE;
    driving_.is_resumed = driving_.is_wanted;
  }
}

void SurveyorNode::note_who_drives() {
  const bool is_active = driving_.is_wanted || driving_.exploration.is_active();
  if (is_active != driving_.is_noted) {
    driving_.is_noted = is_active;
    survey_command_t command{};
    command.utime = now_;
    command.action = is_active ? survey_command_t::ACTION_EXPLORE : survey_command_t::ACTION_STAY;
    record(channels::kSurveyCommand, command);
  }
}

Health SurveyorNode::health() const {
  Health health;
  health.degraded = !failure_.empty();
  health.reason = failure_;
  health.dropped_inputs = subscriber_.dropped();
  return health;
}

template <typename Message>
void SurveyorNode::record(const char* channel, const Message& message) {
  const std::vector<std::uint8_t> bytes = encoded(message);
  try {
    log_->write(message.utime, channel, bytes.data(), bytes.size());
  } catch (const std::runtime_error& error) {
    failure_ = error.what();
  }
}

void SurveyorNode::on_odometry(const odometry_t& message) {
  if (is_recording() && collector_.add(message)) {
    record(channels::kOdometry, message);
    const OdometryReading& reading = collector_.so_far().drive.odometry.back();
    live_.add(reading);
    ground_.add(reading);
    if (ground_.is_narrow()) {
      ground_.redraw(collector_.so_far());
    }
    now_ = message.utime;
    take_results();
    explore();
    note_who_drives();
    ground_publisher_.publish(reading, ground_, driving_.exploration.is_active());
  }
  now_ = message.utime;
  publish_goal();
  take_results();
  if (now_ - published_ >= kPeriod || now_ < published_) {
    publish();
    try {
      log_->sync();
    } catch (const std::runtime_error& error) {
      failure_ = error.what();
    }
  }
}

void SurveyorNode::on_sonar(const sonar_t& message) {
  const std::size_t before = collector_.so_far().drive.echoes.size();
  if (is_recording() && collector_.add(message)) {
    record(channels::kSonar, message);
    const std::vector<SonarEcho>& echoes = collector_.so_far().drive.echoes;
    std::for_each(echoes.begin() + static_cast<std::ptrdiff_t>(before), echoes.end(),
                  [this](const SonarEcho& echo) { ground_.add(echo); });
  }
}

void SurveyorNode::on_camera_image(const camera_image_t& message) {
  if (is_recording() && collector_.add(message)) {
    record(channels::kCameraImage, message);
    ground_.add(collector_.so_far().drive.frames.back());
  }
}

void SurveyorNode::on_fixture_detections(const fixture_detections_t& message) {
  if (is_recording() && collector_.add(message)) {
    record(channels::kFixtureDetections, message);
    ground_.add(collector_.so_far().drive.frames.back());
  }
}

void SurveyorNode::on_navigation_status(const navigation_status_t& message) {
  driving_.exploration.hear(news_of(message, driving_.is_allowed));
}

void SurveyorNode::on_robot_status(const robot_status_t& message) {
  driving_.is_allowed = message.stop_engaged == 0 && message.motors_enabled != 0;
}

void SurveyorNode::on_tile_request(const tile_request_t& message) {
  if (!ground_publisher_.take(message)) {
    subscriber_.drop("TILE_REQUEST of an impossible size");
  }
}

void SurveyorNode::explore() {
  if (driving_.is_wanted && !work_.under_way()) {  // of a long log the estimate comes first
    driving_.is_wanted = false;
    driving_.exploration.begin(std::exchange(driving_.is_resumed, false) ? read_tried_floor(config_.tried_file())
                                                                         : TriedFloor());
  }
  if (driving_.exploration.is_active() && !ground_.here()) {
    driving_.exploration.end(now_, "exploring ended: nobody knows where on the map the robot is; the survey goes on");
  }
  live_.set_exploring(driving_.exploration.is_active());
  if (!driving_.exploration.is_active()) {
    return;
  }
  if (driving_.exploration.is_due(now_)) {
    driving_.exploration.update(now_, {ground_.map().grid(), ground_.looks(collector_.so_far().drive.frames),
                                       ground_.here()->world_from_robot, ground_.drawing()});
  }
  if (driving_.exploration.take_news_of_tried()) {
    keep_tried_floor();
  }
  if (driving_.exploration.phase() == Exploration::Phase::kFinished) {
    note_explored();
    wants_end_ = true;
  }
}

void SurveyorNode::keep_tried_floor() {
  try {
    write_tried_floor(config_.tried_file(), driving_.exploration.tried());
  } catch (const std::runtime_error& error) {
    failure_ = error.what();
  }
}

void SurveyorNode::note_explored() {
  survey_command_t command{};
  command.utime = now_;
  command.action = survey_command_t::ACTION_FINISH;
  command.name = kExplored;
  if (collector_.add(command)) {
    record(channels::kSurveyCommand, command);
  }
}

void SurveyorNode::publish_goal() {
  const std::optional<ExploreGoal>& request = driving_.exploration.request();
  if (!request || (now_ >= driving_.asked && now_ - driving_.asked < kRepeat)) {
    return;
  }
  driving_.asked = now_;
  commands_.publish(channels::kGoal, to_message(*request, now_));
}

void SurveyorNode::on_survey_command(const survey_command_t& message) {
  if (message.id < echo_id_) {
    subscriber_.drop("SURVEY_COMMAND: older than one that was taken");
    return;
  }
  if (message.id > echo_id_) {
    echo_id_ = message.id;
    objection_ = obey(message);
  }
  take_results();
  publish();
}

std::string SurveyorNode::obey(const survey_command_t& command) {
  if (command.action < survey_command_t::ACTION_FINISH || command.action > survey_command_t::ACTION_STAY) {
    return "a survey knows no such command";
  }
  if (collector_.so_far().drive.odometry.empty()) {
    return "nothing was heard of the robot yet: is its driver running?";
  }
  if (command.action == survey_command_t::ACTION_FINISH) {
    driving_.exploration.end(now_, "exploring ended: somebody finished the survey");
    wants_end_ = !is_finished_;
    return "";
  }
  if (!is_recording()) {
    return "the survey is finished: name the place in the building's file, or on the page once the robot drives there";
  }
  if (command.action == survey_command_t::ACTION_EXPLORE) {
    driving_.is_wanted = !driving_.exploration.is_active();
    driving_.is_resumed = false;  // somebody may want it to try everything once more
    return "";
  }
  if (command.action == survey_command_t::ACTION_STAY) {
    driving_.is_wanted = false;
    driving_.exploration.end(now_, "exploring ended by somebody; the survey goes on");
    return "";
  }
  if (!is_name(command.name)) {
    return "a place needs a name of at most 60 letters";
  }
  if (collector_.add(command)) {
    record(channels::kSurveyCommand, command);
  }
  return "";
}

void SurveyorNode::take_results() {
  if (std::optional<SurveyWork::Result> result = work_.take_result()) {
    take(*std::move(result));
    publish();
  }
  if (work_.under_way()) {
    return;
  }
  if (wants_end_) {
    live_.begin_estimate();
    work_.write(collector_.collected(), config_.model,
                {config_.folder, config_.folder / "survey.json", config_.folder / "plan.png", config_.state});
  } else if (live_.is_estimate_due()) {  // of a finished one too: its page shows the map
    live_.begin_estimate();
    work_.estimate(collector_.collected(), config_.model);
  }
}

void SurveyorNode::take(SurveyWork::Result result) {
  if (result.kind == SurveyWork::Kind::kWrite) {
    wants_end_ = false;
    is_finished_ = result.estimate.has_value();
    failure_ = result.failure;
  } else {
    no_estimate_ = result.failure;
  }
  if (result.estimate) {
    if (result.kind == SurveyWork::Kind::kEstimate) {
      ground_.take(*result.estimate, collector_.so_far());
    }
    failure_.clear();  // somebody was in too great a hurry to finish
    live_.take(*std::move(result.estimate));
  }
}

void SurveyorNode::settle() {
  while (work_.under_way()) {
    work_.wait();
    take_results();
  }
}

std::int8_t SurveyorNode::state() const {
  if (is_finished_) {
    return survey_status_t::STATE_FINISHED;
  }
  if (wants_end_) {
    return survey_status_t::STATE_WRITING;
  }
  if (!failure_.empty()) {
    return survey_status_t::STATE_FAILED;
  }
  return work_.under_way() ? survey_status_t::STATE_ESTIMATING : survey_status_t::STATE_DRIVING;
}

std::string SurveyorNode::reason() const {
  return failure_.empty() ? no_estimate_ : failure_;
}

void SurveyorNode::publish() {
  survey_status_t message = to_message(live_.map(collector_.so_far()), config_.model.kinds);
  message.utime = now_;
  message.sequence = sequence_++;
  message.state = state();
  message.reason = reason();
  message.folder = config_.folder.string();
  message.echo_id = echo_id_;
  message.objection = objection_;
  message.is_exploring = driving_.exploration.is_active();
  message.exploring = driving_.exploration.sentence();
  lcm_.publish(channels::kSurveyStatus, &message);
  published_ = now_;
}

}  // namespace luminav
