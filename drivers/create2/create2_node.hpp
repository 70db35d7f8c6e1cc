#pragma once

#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/supervision_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base/base_driver.hpp"
#include "drivers/base/safety/life_sign.hpp"
#include "drivers/base/safety/stop_latch.hpp"
#include "drivers/base/safety/velocity_gate.hpp"
#include "drivers/create2/create2_config.hpp"
#include "drivers/create2/hazard_watch.hpp"
#include "drivers/create2/line/create2_link.hpp"
#include "drivers/create2/power_supervisor.hpp"
#include "drivers/create2/wheel_odometry.hpp"
#include "drivers/create2/wheel_writer.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// An iRobot Create 2 on the network: ODOMETRY at 10 Hz, ROBOT_STATUS at 50 Hz; obeys VELOCITY_COMMAND, STOP and
/// MOTORS_COMMAND. What it touches and where the floor ends stops its wheels here, before anybody else hears of it.
class Create2Node final : public BaseDriver {
 public:
  Create2Node(lcm::LCM& lcm, const Create2Config& config, const Clock& clock, OpenStream open_stream,
              std::optional<CommandKey> key = {});

  void poll() override;
  void report_life(std::function<void()> tell_guardian) override { life_.report_to(std::move(tell_guardian)); }
  [[nodiscard]] int descriptor() const override { return link_.descriptor(); }
  [[nodiscard]] int openings() const override { return link_.openings(); }
  [[nodiscard]] Health health() const override;
  [[nodiscard]] const std::vector<std::string>& channels() const override { return subscriber_.channels(); }
  void hold(const std::string& why) override { held_because_ = why; }
  bool stand_still() override;
  void shut_down() override;
  [[nodiscard]] bool connected() const override { return link_.connected() && session_ != 0; }
  [[nodiscard]] std::string describe_line() const override;

 private:
  void on_velocity_command(const velocity_command_t& message);
  void on_stop(const stop_t& message);
  void on_supervision(const supervision_t&) { watched_ = clock_.utime(); }
  void on_motors_command(const motors_command_t& message);

  /// The time; to be called before anything is said on the line, which others may have used while this process slept.
  std::int64_t wake();
  void obey_stop(std::int64_t now, std::int64_t id, bool engaged, const std::string& sender);
  void on_reading(const TimedReading& received, std::int64_t now);
  void command_motion(std::int64_t now);
  void publish_odometry(std::int64_t utime);
  void publish_status(std::int64_t now);
  [[nodiscard]] bool has_motors() const { return connected() && PowerSupervisor::has_motors(last_); }
  [[nodiscard]] std::string reason(std::int64_t now) const;

  lcm::LCM& lcm_;
  Create2Config config_;
  const Clock& clock_;
  Create2Link link_;
  WheelOdometry odometry_;
  VelocityGate gate_;
  WheelWriter writer_;
  StopLatch stop_;
  HazardWatch hazards_;
  PowerSupervisor power_;
  LifeSign life_;
  SensorReading last_;        // the last that was believed
  std::int64_t session_ = 0;  // [us] 0 = not connected
  std::int32_t odometry_sequence_ = 0;
  std::int32_t status_sequence_ = 0;
  std::int64_t next_odometry_ = 0;  // [us]
  std::int64_t next_status_ = 0;    // [us]
  std::int64_t last_wake_ = 0;      // [us]
  std::int64_t impossible_readings_ = 0;
  std::int64_t last_motors_command_ = 0;  // id
  std::int64_t watched_ = 0;              // [us] when somebody last watched, or this began
  std::string held_because_;
  bool standing_still_ = false;  // for good
  Subscriber subscriber_;
};

}  // namespace luminav
