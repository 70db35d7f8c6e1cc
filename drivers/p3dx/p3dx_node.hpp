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

#include "drivers/p3dx/dead_reckoning.hpp"
#include "drivers/p3dx/line/arcos_link.hpp"
#include "drivers/p3dx/line/byte_stream.hpp"
#include "drivers/p3dx/motion_settings.hpp"
#include "drivers/p3dx/p3dx_config.hpp"
#include "drivers/p3dx/safety/motors_supervisor.hpp"
#include "drivers/p3dx/safety/stop_latch.hpp"
#include "drivers/p3dx/safety/velocity_gate.hpp"
#include "drivers/p3dx/safety/wheel_watch.hpp"
#include "drivers/p3dx/sonar_collector.hpp"
#include "drivers/p3dx/velocity_writer.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// The robot's base on the network: ODOMETRY and SONAR with each information packet (10 Hz), ROBOT_STATUS at 50 Hz;
/// obeys VELOCITY_COMMAND, STOP and MOTORS_COMMAND. Runs by the clock it is given and never waits.
class P3dxNode {
 public:
  P3dxNode(lcm::LCM& lcm, const P3dxConfig& config, const Clock& clock, OpenStream open_stream,
           std::optional<CommandKey> key = {});

  /// Reads and writes the line and runs what is due. To be called at least every 20 ms, and when descriptor() can be
  /// read.
  void poll();
  /// How its guardian is told that the driver lives; done every 55 ms by poll(). A session that the guardian may have
  /// ended meanwhile is begun anew, once the guardian is done with the line.
  void report_life(std::function<void()> tell_guardian) { tell_guardian_ = std::move(tell_guardian); }
  /// Of the line; -1 while there is none.
  [[nodiscard]] int descriptor() const { return link_.descriptor(); }
  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }
  /// The robot stands for as long as there is a reason; "" = no more.
  void hold(const std::string& why);
  /// From now on the robot is told to stand, whatever is commanded; true once it does, or does not answer.
  bool stand_still();
  /// Stop, motors off, CLOSE; to be called before the end. Bytes that the line does not take at once are lost.
  void shut_down();
  /// The robot answers and its information packets arrive.
  [[nodiscard]] bool connected() const { return link_.connected(); }
  [[nodiscard]] const ArcosLink& link() const { return link_; }
  /// The state of the line in one sentence, for people; says what the robot's watchdog costs.
  [[nodiscard]] std::string describe_line() const;

 private:
  void on_velocity_command(const velocity_command_t& message);
  void on_stop(const stop_t& message);
  void on_supervision(const supervision_t& message);
  void on_motors_command(const motors_command_t& message);

  /// The time; to be called before anything is said on the line, which others may have used while this process slept.
  std::int64_t wake();
  [[nodiscard]] bool guardian_heard_nothing(std::int64_t now) const;
  void beat();
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
  DriveVelocity told_;        // the robot, last
  InformationPacket last_;    // the last that was believed
  std::int64_t session_ = 0;  // [us] 0 = not connected
  std::int32_t odometry_sequence_ = 0;
  std::int32_t sonar_sequence_ = 0;
  std::int32_t status_sequence_ = 0;
  std::int64_t next_status_ = 0;  // [us]
  std::int64_t last_wake_ = 0;    // [us]
  std::int64_t last_beat_ = 0;    // [us] just before the guardian was told; 0 = not yet
  bool beat_was_late_ = false;    // too late for the guardian, perhaps
  std::function<void()> tell_guardian_;
  std::int64_t impossible_packets_ = 0;
  std::int64_t last_motors_command_ = 0;  // id
  std::string held_because_;
  std::int64_t watched_ = 0;     // [us] when somebody last watched, or this began
  bool standing_still_ = false;  // for good
  Subscriber subscriber_;
};

}  // namespace luminav
