#include "services/operator/system_snapshot.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "services/common/geometry/angle.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/operator/goal_order.hpp"

namespace luminav {
namespace {

std::string with_reason(const std::string& line, const std::string& reason) {
  return reason.empty() ? line : line + ": " + reason;
}

std::string robot_line(const robot_status_t& robot) {
  if (!robot.connected) {
    return with_reason(fmt::format("{}, not connected", robot.robot), robot.reason);
  }
  std::string line =
      fmt::format("{}, {:.1f} V, motors {}", robot.robot, robot.battery_voltage, robot.motors_enabled ? "on" : "off");
  line += robot.stop_engaged ? ", stop engaged" : "";
  line += robot.stop_button ? ", stop button pressed" : "";
  line += robot.stall_left || robot.stall_right ? ", wheel blocked" : "";
  return with_reason(line, robot.reason);
}

std::string pose_line(const pose_t& pose) {
  std::string line = pose_state_name(pose.state);
  if (pose.state == pose_t::STATE_TRACKING) {
    line += fmt::format(" at ({:.2f}, {:.2f}) {:.0f} deg ({:.2f} rad), +-{:.2f} m", pose.x, pose.y, degrees(pose.theta),
                        pose.theta, position_sigma(pose));
  }
  return with_reason(line, pose.reason);
}

std::string navigation_line(const navigation_status_t& navigation) {
  std::string line = navigation_state_name(navigation.state);
  if (navigation.has_target) {
    line += fmt::format(" to ({:.2f}, {:.2f}), {:.1f} m left", navigation.x, navigation.y, navigation.distance_left);
  }
  if (navigation.pose_count > 1) {
    line += fmt::format(", stop {} of {}", navigation.pose_index + 1, navigation.pose_count);
  }
  return with_reason(line, navigation.cause);
}

std::string control_line(const control_status_t& control) {
  return with_reason(fmt::format("{}, {:.2f} m/s, {:.0f} deg/s, {:.2f} m clear", control_state_name(control.state),
                                 control.linear, degrees(control.angular), control.clearance),
                     control.reason);
}

const char* node_state_name(int state) {
  static constexpr const char* kNames[] = {"starting", "ready", "degraded", "fault"};
  return state >= 0 && state <= 3 ? kNames[state] : "unknown";
}

std::string node_line(const node_status_t& node) {
  const char* state = node_state_name(node.state);
  const std::string line = fmt::format("{:<12} {:<9} {:>4.1f} % cpu {:>5.0f} MB", node.process, state,
                                       100.0 * node.cpu_fraction, static_cast<double>(node.memory_bytes) / 1e6);
  return with_reason(node.host.empty() ? line : line + "  on " + node.host,
                     node.state == node_status_t::STATE_READY ? "" : node.reason);
}

// A number that is not finite has no JSON: null.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json json_of(const robot_status_t& robot) {
  return {{"name", robot.robot},
          {"connected", robot.connected != 0},
          {"battery_v", number(robot.battery_voltage)},
          {"motors_enabled", robot.motors_enabled != 0},
          {"stop_engaged", robot.stop_engaged != 0},
          {"stop_button", robot.stop_button != 0},
          {"wheel_blocked", robot.stall_left != 0 || robot.stall_right != 0},
          {"linear_m_s", number(robot.linear)},
          {"angular_rad_s", number(robot.angular)},
          {"reason", robot.reason}};
}

nlohmann::json json_of(const pose_t& pose) {
  return {{"state", pose_state_name(pose.state)},
          {"x", number(pose.x)},
          {"y", number(pose.y)},
          {"theta_rad", number(pose.theta)},
          {"reason", pose.reason}};
}

nlohmann::json json_of(const navigation_status_t& navigation) {
  nlohmann::json json = {{"state", navigation_state_name(navigation.state)},
                         {"distance_left_m", number(navigation.distance_left)},
                         {"stop", navigation.pose_index + 1},
                         {"stops", navigation.pose_count},
                         {"cause", navigation.cause},
                         {"target", nullptr}};
  if (navigation.has_target) {
    json["target"] = {number(navigation.x), number(navigation.y)};
  }
  return json;
}

nlohmann::json json_of(const control_status_t& control) {
  return {{"state", control_state_name(control.state)},
          {"clearance_m", number(control.clearance)},
          {"reason", control.reason}};
}

nlohmann::json json_of(const node_status_t& node) {
  return {{"process", node.process},
          {"host", node.host},
          {"state", node_state_name(node.state)},
          {"reason", node.reason},
          {"cpu", number(node.cpu_fraction)},
          {"memory_bytes", node.memory_bytes}};
}

template <typename Message>
nlohmann::json json_of(const std::optional<Message>& message) {
  return message ? json_of(*message) : nlohmann::json(nullptr);
}

}  // namespace

SystemSnapshot::SystemSnapshot(lcm::LCM& lcm) : subscriber_(lcm) {
  subscriber_.on(channels::kRobotStatus, &SystemSnapshot::on_robot_status, this);
  subscriber_.on(channels::kPose, &SystemSnapshot::on_pose, this);
  subscriber_.on(channels::kNavigationStatus, &SystemSnapshot::on_navigation_status, this);
  subscriber_.on(channels::kControlStatus, &SystemSnapshot::on_control_status, this);
  subscriber_.on(channels::kNodeStatus, &SystemSnapshot::on_node_status, this);
}

bool SystemSnapshot::is_empty() const {
  return !robot_ && !pose_ && !navigation_ && !control_ && nodes_.empty();
}

std::string SystemSnapshot::page() const {
  const auto line = [](const char* title, const std::string& text) { return fmt::format("{:<10} {}\n", title, text); };
  std::string page = line("robot", robot_ ? robot_line(*robot_) : "no word from the driver");
  if (const auto files = system_.files()) {
    page += line("building", files->building);
  }
  if (const std::string text = system_.disagreement(0); !text.empty()) {
    page += line("FAULT", "the processes do not belong together: " + text);
  }
  page += line("pose", pose_ ? pose_line(*pose_) : "no word from the localizer");
  page += line("goal", navigation_ ? navigation_line(*navigation_) : "no word from the planner");
  page += line("control", control_ ? control_line(*control_) : "no word from the controller");
  page += nodes_.empty() ? line("processes", "none has reported") : "processes\n";
  for (const auto& [name, node] : nodes_) {
    page += "  " + node_line(node) + "\n";
  }
  return page;
}

std::string SystemSnapshot::json() const {
  const auto files = system_.files();
  nlohmann::json processes = nlohmann::json::array();
  for (const auto& [name, node] : nodes_) {
    processes.push_back(json_of(node));
  }
  const nlohmann::json all = {{"robot", json_of(robot_)},
                              {"building", files ? nlohmann::json(files->building) : nlohmann::json(nullptr)},
                              {"disagreement", system_.disagreement(0)},
                              {"pose", json_of(pose_)},
                              {"goal", json_of(navigation_)},
                              {"control", json_of(control_)},
                              {"processes", processes}};
  return all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace luminav
