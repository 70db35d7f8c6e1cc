#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"
#include "drivers/simulator/arcos/arcos_motion.hpp"
#include "drivers/simulator/arcos/arcos_odometry.hpp"
#include "drivers/simulator/arcos/arcos_sonar.hpp"
#include "drivers/simulator/arcos/packet_schedule.hpp"
#include "drivers/simulator/arcos/stall_rules.hpp"
#include "drivers/simulator/base_board.hpp"

namespace luminav {

/// How the simulated microcontroller behaves.
struct ArcosConfig {
  ConfigurationPacket flash;  // what it has stored: limits, watchdog, cadence, name, subclass
  double wheel_base = 0.33;   // [m] with which it turns wheel travel into its heading
  bool mobilesim = false;     // habits of MobileSim: motors on at start, all sonar in each packet, no watchdog,
                              // heading in whole degrees, always 0x32, stops when the line closes
};

using ArcosInputs = BoardInputs;
using ArcosOutputs = BoardOutputs;

/// The microcontroller of a Pioneer (ARCOS) as a state machine: bytes and wheel travel in, bytes and wheel speeds out.
/// Neither I/O nor clock: time is what `step` is told. Motors are off after OPEN; its watchdog halts the robot after
/// silence and lets it resume with the next packet.
class ArcosController final : public BaseBoard {
 public:
  explicit ArcosController(const ArcosConfig& config);

  void receive(std::span<const std::uint8_t> bytes) override;
  ArcosOutputs step(double dt, const ArcosInputs& inputs) override;
  /// 5 m or more = no echo.
  void set_sonar_reading(int disc, double range) override;
  std::vector<std::uint8_t> take_output() override;
  void on_line_closed() override;
  /// As HOSTBAUD set it last.
  [[nodiscard]] int baud() const override;
  [[nodiscard]] bool session_open() const { return session_open_; }
  [[nodiscard]] std::int64_t bad_packets() const { return parser_.bad_packets(); }

 private:
  void obey_packets();
  void on_sync(std::uint8_t command);
  void open_session();
  void close_session();
  void execute(ArcosCommand command, const CommandArgument& argument, std::span<const std::uint8_t> payload);
  void execute_setting(ArcosCommand command, int value);
  void execute_motion(ArcosCommand command, int value);
  void enable_motors(bool enable);
  void sense(double dt, const ArcosInputs& inputs);
  void send(std::vector<std::uint8_t> frame);
  void send_information();
  [[nodiscard]] ConfigurationPacket configuration() const;
  InformationPacket information();  // takes the sonar readings

  ArcosConfig config_;
  PacketParser parser_;
  ArcosMotion motion_;
  ArcosSonar sonar_;
  ArcosOdometry odometry_;
  StallRules stalls_;
  PacketSchedule schedule_;
  std::vector<std::uint8_t> output_;
  int sync_count_ = 0;
  bool session_open_ = false;
  bool motors_enabled_ = false;
  int analog_port_ = 0;
  int digital_out_ = 0;
  int baud_code_ = 0;
  std::optional<double> fake_battery_;  // [V]
  ArcosInputs sensed_;
  std::int64_t now_ = 0;          // [us] since it was switched on
  std::int64_t last_packet_ = 0;  // [us] a valid one
};

}  // namespace luminav
