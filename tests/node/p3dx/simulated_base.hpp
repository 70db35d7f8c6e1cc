#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "drivers/base/line/byte_stream.hpp"
#include "drivers/simulator/arcos/arcos_controller.hpp"
#include "drivers/simulator/base_board.hpp"

namespace luminav {

/// A simulated controller on wheels that do exactly as they are told, in an empty world. Time in steps of 10 ms.
class SimulatedBase {
 public:
  explicit SimulatedBase(const ArcosConfig& config = {}) : controller_(config), wheel_base_(config.wheel_base) {}

  /// `takes_output` false leaves the controller's output to a server.
  void step(ByteStream* line, bool takes_output = true) {
    receive(line);
    constexpr double kStep = 0.01;
    BoardInputs now = inputs;
    if (!blocked) {
      now.left_travel = kStep * (outputs.linear - 0.5 * wheel_base_ * outputs.angular);
      now.right_travel = kStep * (outputs.linear + 0.5 * wheel_base_ * outputs.angular);
    }
    true_left += now.left_travel;
    now.left_travel = dead_left ? 0.0 : now.left_travel;
    now.right_travel = dead_right ? 0.0 : now.right_travel;
    now.left_travel += kStep * runaway_left;
    travel += 0.5 * std::abs(now.left_travel + now.right_travel);
    turned += (now.right_travel - now.left_travel) / wheel_base_;
    outputs = controller_.step(kStep, now);
    for (const int disc : outputs.sonar_discs) {
      controller_.set_sonar_reading(disc, 1.0 + 0.1 * disc);
    }
    if (takes_output) {
      const std::vector<std::uint8_t> output = controller_.take_output();
      if (line != nullptr) {
        line->write(output);
      }
    }
  }

  /// Obeys what has come, while no time goes by.
  void receive(ByteStream* line) {
    if (line == nullptr) {
      return;
    }
    std::array<std::uint8_t, 4096> bytes;
    const auto received = std::span(bytes).first(line->read(bytes));
    controller_.receive(received);
    parser_.push(received);
    while (const auto packet = parser_.next()) {
      heard.push_back(encode_packet(packet->type, packet->payload));
    }
  }

  ArcosController& controller() { return controller_; }
  [[nodiscard]] const ArcosController& controller() const { return controller_; }

  BoardInputs inputs;
  BoardOutputs outputs;
  bool blocked = false;
  bool dead_left = false;                        // the encoder counts nothing
  bool dead_right = false;                       // likewise
  double runaway_left = 0.0;                     // [m/s] the wheel turns, whatever it is told
  double true_left = 0.0;                        // [m] of the wheel, whatever its encoder counts
  double travel = 0.0;                           // [m]
  double turned = 0.0;                           // [rad]
  std::vector<std::vector<std::uint8_t>> heard;  // whole frames from the client

 private:
  ArcosController controller_;
  PacketParser parser_;
  double wheel_base_;
};

}  // namespace luminav
