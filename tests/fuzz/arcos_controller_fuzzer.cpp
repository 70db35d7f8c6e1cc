#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "drivers/simulator/arcos/arcos_controller.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

}  // namespace

/// The first byte chooses habits and senses. Then commands, framed here so that they pass the checksum: a byte for the
/// steps that go by, the number, the length of the payload, the payload. Whatever a client says, the robot stays within
/// its limits, its packets are whole, and without motors it does not move.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span input(data, size);
  const auto take = [&] {
    const std::uint8_t byte = input.empty() ? 0 : input.front();
    input = input.empty() ? input : input.subspan(1);
    return byte;
  };
  const std::uint8_t habits = take();
  ArcosConfig config;
  config.mobilesim = (habits & 1) != 0;
  ArcosController controller(config);
  if ((habits & 2) != 0) {
    for (const std::uint8_t sync : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{1}}) {
      controller.receive(encode_packet(sync));
    }
  }
  ArcosInputs inputs;
  ArcosOutputs outputs;
  PacketParser parser;
  int steps_without_motors = 0;
  while (!input.empty()) {
    const std::uint8_t control = take();
    const std::uint8_t number = take();
    const std::size_t length = std::min<std::size_t>(take(), input.size());
    const auto payload = input.first(length);
    input = input.subspan(length);
    if ((control & 0x80) != 0) {
      controller.receive(payload);  // raw
    } else {
      controller.receive(encode_packet(number, payload));
    }
    inputs.stop_button = (control & 0x40) != 0;
    inputs.motors_button = (control & 0x20) != 0;
    inputs.stall_left = (control & 0x10) != 0;
    for (int i = 0; i < (control & 0x0F); ++i) {
      inputs.left_travel = 0.01 * (outputs.linear - 0.165 * outputs.angular);
      inputs.right_travel = 0.01 * (outputs.linear + 0.165 * outputs.angular);
      outputs = controller.step(0.01, inputs);
      for (const int disc : outputs.sonar_discs) {
        require(disc >= 0 && disc < 16);
        controller.set_sonar_reading(disc, 0.1 * disc);
      }
      require(std::isfinite(outputs.linear) && std::abs(outputs.linear) <= 1.0 + 1e-9);
      require(std::isfinite(outputs.angular) && std::abs(outputs.angular) <= 6.2832 + 1e-9);
      steps_without_motors = outputs.motors_enabled ? 0 : steps_without_motors + 1;
      require(steps_without_motors < 100 || (outputs.linear == 0.0 && outputs.angular == 0.0));
    }
    parser.push(controller.take_output());
    while (const auto packet = parser.next()) {
      require(!is_information(packet->type) || decode_information(packet->type, packet->payload).has_value());
    }
    require(parser.bad_packets() == 0 && !parser.has_partial());
  }
  return 0;
}
