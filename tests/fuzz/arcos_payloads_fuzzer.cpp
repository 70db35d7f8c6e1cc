#include <cmath>
#include <cstdlib>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

std::span<const std::uint8_t> payload_of(const std::vector<std::uint8_t>& frame) {
  return std::span(frame).subspan(4, frame.size() - 6);
}

}  // namespace

/// The first byte is the packet's type, the rest its payload. What was read is written and read again the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || size > kLargestPayload + 1) {
    return 0;
  }
  const std::span payload(data + 1, size - 1);
  if (const auto packet = decode_information(data[0], payload)) {
    require(packet->sonar.size() * 3 <= payload.size());
    if (packet->sonar.size() <= 70) {  // more cannot be written with the whole tail
      const auto frame = encode_information(*packet);
      const auto again = decode_information(frame[3], payload_of(frame));
      require(again.has_value() && again->x_mm == packet->x_mm && again->heading == packet->heading);
      require(again->sonar.size() == packet->sonar.size() && again->motors_enabled == packet->motors_enabled);
    }
  }
  if (const auto packet = decode_configuration(payload)) {
    require(packet->name.size() <= 40);
    const auto frame = encode_configuration(*packet);
    const auto again = decode_configuration(payload_of(frame));
    require(again.has_value() && again->watchdog == packet->watchdog && again->firmware == packet->firmware);
  }
  const RobotIdentity identity = decode_identity(payload);
  require(identity.subclass.size() <= 40);
  decode_encoder(payload);
  if (const auto packet = decode_input_output(payload)) {
    require(packet->analog.size() * 2 <= payload.size());
  }
  const CommandArgument argument = decode_argument(payload);
  require(std::abs(argument.value) <= 65535 && argument.text.size() <= payload.size());
  const WheelVelocities wheels = decode_wheel_velocities(argument.value);
  require(std::abs(wheels.left) <= 128 && std::abs(wheels.right) <= 128);
  return 0;
}
