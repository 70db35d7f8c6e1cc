#include "services/viewer/http/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxProcesses = 200;
constexpr std::int64_t kForgotten = 60'000'000;  // [us]
constexpr double kLongestStep = 0.5;             // [m] between two odometries; what is longer is no driving

constexpr std::array<std::pair<std::int8_t, const char*>, 6> kEndings{
    {{navigation_status_t::STATE_ARRIVED, "arrived"},
     {navigation_status_t::STATE_NO_PATH, "no_path"},
     {navigation_status_t::STATE_BLOCKED, "blocked"},
     {navigation_status_t::STATE_STUCK, "stuck"},
     {navigation_status_t::STATE_CANCELLED, "cancelled"},
     {navigation_status_t::STATE_LOST, "lost"}}};

bool is_ending(std::int8_t state) {
  return std::any_of(kEndings.begin(), kEndings.end(), [&](const auto& ending) { return ending.first == state; });
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '\\' || letter == '"') {
      result += '\\';
    }
    result += letter == '\n' ? ' ' : letter;
  }
  return result;
}

/// Lines of one metric below its head.
class Lines {
 public:
  void begin(std::string name, const char* type, const char* help) {
    name_ = std::move(name);
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name_, help, name_, type);
  }
  template <typename Number>
  void add(Number value, const std::string& labels = "") {
    text_ += labels.empty() ? fmt::format("{} {}\n", name_, value) : fmt::format("{}{{{}}} {}\n", name_, labels, value);
  }
  template <typename Number>
  void one(std::string name, const char* type, const char* help, Number value) {
    begin(std::move(name), type, help);
    add(value);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string name_;
  std::string text_;
};

}  // namespace

Metrics::Metrics(lcm::LCM& lcm) : subscriber_(lcm) {
  subscriber_.on(channels::kOdometry, &Metrics::on_odometry, this);
  subscriber_.on(channels::kRobotStatus, &Metrics::on_robot_status, this);
  subscriber_.on(channels::kNavigationStatus, &Metrics::on_navigation_status, this);
  subscriber_.on(channels::kPose, &Metrics::on_pose, this);
  subscriber_.on(channels::kNodeStatus, &Metrics::on_node_status, this);
  subscriber_.on(channels::kSimTruth, &Metrics::on_sim_truth, this);
}

void Metrics::on_odometry(const odometry_t& message) {
  if (odometry_ && odometry_->session == message.session) {
    const double step = std::hypot(message.x - odometry_->x, message.y - odometry_->y);
    distance_ += step < kLongestStep ? step : 0.0;
  }
  odometry_ = message;
}

void Metrics::on_robot_status(const robot_status_t& message) {
  const bool is_bumping = message.bumpers_front != 0 || message.bumpers_rear != 0;
  const bool is_stalled = message.stall_left != 0 || message.stall_right != 0;
  contacts_.bumper += is_bumping && !contacts_.is_bumping ? 1 : 0;
  contacts_.stall += is_stalled && !contacts_.is_stalled ? 1 : 0;
  contacts_.is_bumping = is_bumping;
  contacts_.is_stalled = is_stalled;
  robot_ = message;
}

// A goal ends when its state does; the same ending may be told for hours.
void Metrics::on_navigation_status(const navigation_status_t& message) {
  const bool is_news = navigation_ && (navigation_->state != message.state || navigation_->goal_id != message.goal_id);
  if (is_news && is_ending(message.state)) {
    ++goals_[message.state];
  }
  navigation_ = message;
}

void Metrics::on_pose(const pose_t& message) {
  pose_ = message;
}

void Metrics::on_node_status(const node_status_t& message) {
  const std::pair name(message.process, message.host);
  if (processes_.size() >= kMaxProcesses && !processes_.contains(name)) {
    return;
  }
  Process& process = processes_[name];
  const bool is_known = process.status.instance != 0;
  process.restarts += is_known && process.status.instance != message.instance ? 1 : 0;
  process.status = message;
  process.heard = 0;
}

void Metrics::on_sim_truth(const sim_truth_t& message) {
  truth_ = message;
}

std::string Metrics::text(std::int64_t now) {
  for (auto& [name, process] : processes_) {
    process.heard = process.heard == 0 ? now : process.heard;
  }
  std::erase_if(processes_, [&](const auto& entry) { return now - entry.second.heard > kForgotten; });
  return process_lines() + robot_lines() + navigation_lines();
}

std::string Metrics::process_lines() const {
  Lines lines;
  const auto each = [&](const char* name, const char* type, const char* help, const auto& value_of) {
    lines.begin(fmt::format("luminav_process_{}", name), type, help);
    for (const auto& [key, process] : processes_) {
      lines.add(value_of(process), fmt::format(R"(process="{}",host="{}")", escaped(key.first), escaped(key.second)));
    }
  };
  each("cpu_fraction", "gauge", "Of one core.", [](const Process& p) { return p.status.cpu_fraction; });
  each("memory_bytes", "gauge", "Resident memory.", [](const Process& p) { return p.status.memory_bytes; });
  each("restarts_total", "counter", "Seen since the viewer started.", [](const Process& p) { return p.restarts; });
  each("lost_inputs_total", "counter", "Messages refused since the process started.",
       [](const Process& p) { return p.status.dropped_inputs; });
  each("worst_step_seconds", "gauge", "Longest handler in the last second.",
       [](const Process& p) { return p.status.worst_step_us * 1e-6; });
  each("state", "gauge", "0 starting, 1 ready, 2 degraded, 3 fault.",
       [](const Process& p) { return int{p.status.state}; });
  return lines.text();
}

std::string Metrics::robot_lines() const {
  Lines lines;
  if (robot_) {
    lines.one("luminav_battery_volts", "gauge", "0 = unknown.", robot_->battery_voltage);
    lines.one("luminav_robot_connected", "gauge", "1 = the line to the robot answers.", int{robot_->connected});
    lines.one("luminav_motors_enabled", "gauge", "1 = as the robot says.", int{robot_->motors_enabled});
    lines.one("luminav_stop_engaged", "gauge", "1 = a STOP is in force.", int{robot_->stop_engaged});
    lines.begin("luminav_contacts_total", "counter",
                "Touches seen since the viewer started; simulated: since the simulation did.");
    lines.add(contacts_.bumper, R"(kind="bumper")");
    lines.add(contacts_.stall, R"(kind="stall")");
    if (truth_) {
      lines.add(truth_->contacts + truth_->hard_contacts, R"(kind="simulated")");
    }
  }
  if (odometry_) {
    lines.one("luminav_distance_meters_total", "counter", "Driven since the viewer started, by odometry.", distance_);
  }
  return lines.text();
}

std::string Metrics::navigation_lines() const {
  Lines lines;
  if (pose_) {
    lines.one("luminav_pose_state", "gauge", "0 lost, 1 ambiguous, 2 tracking.", int{pose_->state});
    lines.one("luminav_meters_since_fixture", "gauge", "Driven since a fixture was used.",
              pose_->distance_since_fixture);
    if (pose_->fixture_utime > 0) {
      lines.one("luminav_seconds_since_fixture", "gauge", "Since the last image whose fixtures were used.",
                static_cast<double>(pose_->utime - pose_->fixture_utime) * 1e-6);
    }
  }
  if (navigation_) {
    lines.one("luminav_navigation_state", "gauge", "STATE of NAVIGATION_STATUS, see /api/openapi.json.",
              int{navigation_->state});
    lines.begin("luminav_goals_total", "counter", "Goals that ended since the viewer started.");
    for (const auto& [state, name] : kEndings) {
      const auto found = goals_.find(state);
      lines.add(found == goals_.end() ? 0 : found->second, fmt::format(R"(outcome="{}")", name));
    }
  }
  return lines.text();
}

}  // namespace luminav
