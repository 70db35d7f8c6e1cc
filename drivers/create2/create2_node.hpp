#pragma once

#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base/base_driver.hpp"
#include "drivers/base/command_desk.hpp"
#include "drivers/create2/create2_config.hpp"
#include "drivers/create2/hazard_watch.hpp"
#include "drivers/create2/line/create2_link.hpp"
#include "drivers/create2/power_supervisor.hpp"
#include "drivers/create2/wheel_odometry.hpp"
#include "drivers/create2/wheel_writer.hpp"
#include "services/common/process/clock.hpp"

namespace luminav {

/// An iRobot Create 2 on the network: ODOMETRY at 10 Hz, ROBOT_STATUS at 50 Hz; obeys VELOCITY_COMMAND, STOP and
/// MOTORS_COMMAND. What it touches and where the floor ends stops its wheels here, before anybody else hears of it.
class Create2Node final : public BaseDriver, private CommandedBase {
 public:
  Create2Node(lcm::LCM& lcm, const Create2Config& config, const Clock& clock, OpenStream open_stream,
              std::optional<CommandKey> key = {});

  void poll() override;
  void report_life(std::function<void()> tell_guardian) override { desk_.report_life(std::move(tell_guardian)); }
  [[nodiscard]] int descriptor() const override { return link_.descriptor(); }
  [[nodiscard]] int openings() const override { return link_.openings(); }
  [[nodiscard]] Health health() const override;
  [[nodiscard]] const std::vector<std::string>& channels() const override { return desk_.subscriber().channels(); }
  void hold(const std::string& why) override { desk_.hold(why); }
  bool stand_still() override;
  void shut_down() override;
  [[nodiscard]] bool connected() const override { return link_.connected() && session_ != 0; }
  [[nodiscard]] std::string describe_line() const override;

 private:
  void follow(std::int64_t now) override { command_motion(now); }
  void follow_stop(std::int64_t now) override { command_motion(now); }
  void switch_motors(std::int64_t now, bool enable) override;
  void stand_after_gap(std::int64_t now) override;
  void begin_anew(std::int64_t now, std::int64_t pause) override;
  void on_reading(const TimedReading& received, std::int64_t now);
  void command_motion(std::int64_t now);
  void publish_odometry(std::int64_t utime);
  void publish_status(std::int64_t now);
  [[nodiscard]] bool has_motors() const { return connected() && PowerSupervisor::has_motors(last_); }
  [[nodiscard]] std::string reason(std::int64_t now) const;

  lcm::LCM& lcm_;
  Create2Config config_;
  Create2Link link_;
  WheelOdometry odometry_;
  WheelWriter writer_;
  HazardWatch hazards_;
  PowerSupervisor power_;
  SensorReading last_;        // the last that was believed
  std::int64_t session_ = 0;  // [us] 0 = not connected
  std::int32_t odometry_sequence_ = 0;
  std::int64_t next_odometry_ = 0;  // [us]
  std::int64_t impossible_readings_ = 0;
  CommandDesk desk_;
};

}  // namespace luminav
