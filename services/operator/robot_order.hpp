#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <optional>
#include <string>

#include "services/common/network/command_seal.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// What a person may ask of the base itself, goals apart.
enum class RobotWish { kStop, kRelease, kMotorsOn, kMotorsOff };

/// A STOP, its release, or the switching of the motors: repeated with each `tick` until those who must obey say that
/// they did. A STOP is obeyed when driver and controller both do. Knows no clock: the owner calls `tick` at 5 Hz.
class RobotOrder {
 public:
  /// `id` grows from request to request; `sender` names this terminal in STOP.
  RobotOrder(lcm::LCM& lcm, RobotWish wish, std::int64_t id, const std::string& sender,
             std::optional<CommandKey> key = {});

  /// A fifth of a second has passed. Throws std::runtime_error when the network takes nothing.
  void tick();

  [[nodiscard]] bool is_obeyed() const;
  /// The robot's own word that it does not move.
  [[nodiscard]] bool stands() const;
  /// What is missing, one line.
  [[nodiscard]] std::string progress() const;

 private:
  void on_robot_status(const robot_status_t& message);
  void on_control_status(const control_status_t& message);
  [[nodiscard]] bool obeys(std::int64_t stop_id, bool engaged) const;
  [[nodiscard]] bool is_about_stop() const { return wish_ == RobotWish::kStop || wish_ == RobotWish::kRelease; }

  CommandPublisher commands_;
  Subscriber subscriber_;
  const RobotWish wish_;
  const std::int64_t id_;
  const std::string sender_;
  std::optional<robot_status_t> robot_;
  std::optional<control_status_t> control_;
  bool driver_obeyed_ = false;
  bool controller_obeyed_ = false;
};

}  // namespace luminav
