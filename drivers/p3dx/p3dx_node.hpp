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
#include "drivers/base/line/byte_stream.hpp"
#include "drivers/p3dx/dead_reckoning.hpp"
#include "drivers/p3dx/line/arcos_link.hpp"
#include "drivers/p3dx/motion_settings.hpp"
#include "drivers/p3dx/p3dx_config.hpp"
#include "drivers/p3dx/safety/motors_supervisor.hpp"
#include "drivers/p3dx/safety/wheel_watch.hpp"
#include "drivers/p3dx/sonar_collector.hpp"
#include "drivers/p3dx/velocity_writer.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/event_loop.hpp"

namespace luminav {

/// The robot's base on the network: ODOMETRY and SONAR with each information packet (10 Hz), ROBOT_STATUS at 50 Hz;
/// obeys VELOCITY_COMMAND, STOP and MOTORS_COMMAND. Runs by the clock it is given and never waits.
class P3dxNode final : public BaseDriver, private CommandedBase {
 public:
  P3dxNode(lcm::LCM& lcm, const P3dxConfig& config, const Clock& clock, OpenStream open_stream,
           std::optional<CommandKey> key = {});

  void poll() override;
  void report_life(std::function<void()> tell_guardian) override { desk_.report_life(std::move(tell_guardian)); }
  [[nodiscard]] int descriptor() const override { return link_.descriptor(); }
  [[nodiscard]] int openings() const override { return link_.openings(); }
  [[nodiscard]] Health health() const override;
  [[nodiscard]] const std::vector<std::string>& channels() const override { return desk_.subscriber().channels(); }
  void hold(const std::string& why) override;
  bool stand_still() override;
  void shut_down() override;
  [[nodiscard]] bool connected() const override { return link_.connected(); }
  [[nodiscard]] std::string describe_line() const override;

 private:
  void follow(std::int64_t now) override;
  void follow_stop(std::int64_t now) override;
  void switch_motors(std::int64_t now, bool enable) override;
  void stand_after_gap(std::int64_t now) override;
  void begin_anew(std::int64_t now, std::int64_t pause) override;
  void on_connected();
  void send_settings(std::int64_t now);
  void on_information(const ReceivedInformation& received);
  /// Takes the motors off wheels that do not do what they are told.
  void watch_wheels(std::int64_t utime);
  void command_motion(std::int64_t now);
  void publish_odometry(std::int64_t utime);
  void publish_sonar();
  void publish_status(std::int64_t now);
  [[nodiscard]] std::string reason(std::int64_t now) const;

  lcm::LCM& lcm_;
  P3dxConfig config_;
  const Clock& clock_;
  ArcosLink link_;
  DeadReckoning reckoning_;
  SonarCollector sonar_;
  VelocityWriter writer_;
  MotionSettings settings_;
  MotorsSupervisor motors_;
  WheelWatch wheels_;
  DriveVelocity told_;        // the robot, last
  InformationPacket last_;    // the last that was believed
  std::int64_t session_ = 0;  // [us] 0 = not connected
  std::int32_t odometry_sequence_ = 0;
  std::int32_t sonar_sequence_ = 0;
  std::int64_t impossible_packets_ = 0;
  CommandDesk desk_;
};

}  // namespace luminav
