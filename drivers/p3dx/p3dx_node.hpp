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
#include "drivers/base/line/byte_stream.hpp"
#include "drivers/base/safety/life_sign.hpp"
#include "drivers/base/safety/stop_latch.hpp"
#include "drivers/base/safety/velocity_gate.hpp"
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
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// The robot's base on the network: ODOMETRY and SONAR with each information packet (10 Hz), ROBOT_STATUS at 50 Hz;
/// obeys VELOCITY_COMMAND, STOP and MOTORS_COMMAND. Runs by the clock it is given and never waits.
class P3dxNode final : public BaseDriver {
 public:
  P3dxNode(lcm::LCM& lcm, const P3dxConfig& config, const Clock& clock, OpenStream open_stream,
           std::optional<CommandKey> key = {});

  void poll() override;
  void report_life(std::function<void()> tell_guardian) override { life_.report_to(std::move(tell_guardian)); }
  [[nodiscard]] int descriptor() const override { return link_.descriptor(); }
  [[nodiscard]] int openings() const override { return link_.openings(); }
  [[nodiscard]] Health health() const override;
  [[nodiscard]] const std::vector<std::string>& channels() const override { return subscriber_.channels(); }
  void hold(const std::string& why) override;
  bool stand_still() override;
  void shut_down() override;
  [[nodiscard]] bool connected() const override { return link_.connected(); }
  [[nodiscard]] const ArcosLink& link() const { return link_; }
  [[nodiscard]] std::string describe_line() const override;

 private:
  void on_velocity_command(const velocity_command_t& message);
  void on_stop(const stop_t& message);
  void on_supervision(const supervision_t& message);
  void on_motors_command(const motors_command_t& message);

  /// The time; to be called before anything is said on the line, which others may have used while this process slept.
  std::int64_t wake();
  void obey_stop(std::int64_t now, std::int64_t id, bool engaged, const std::string& sender);
  [[nodiscard]] bool is_unsupervised(std::int64_t now) const;
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
  VelocityGate gate_;
  VelocityWriter writer_;
  MotionSettings settings_;
  StopLatch stop_;
  MotorsSupervisor motors_;
  WheelWatch wheels_;
  LifeSign life_;
  DriveVelocity told_;        // the robot, last
  InformationPacket last_;    // the last that was believed
  std::int64_t session_ = 0;  // [us] 0 = not connected
  std::int32_t odometry_sequence_ = 0;
  std::int32_t sonar_sequence_ = 0;
  std::int32_t status_sequence_ = 0;
  std::int64_t next_status_ = 0;  // [us]
  std::int64_t last_wake_ = 0;    // [us]
  std::int64_t impossible_packets_ = 0;
  std::int64_t last_motors_command_ = 0;  // id
  std::string held_because_;
  std::int64_t watched_ = 0;     // [us] when somebody last watched, or this began
  bool standing_still_ = false;  // for good
  Subscriber subscriber_;
};

}  // namespace luminav
