#include "drivers/p3dx/safety/arcos_guard.hpp"

#include <cmath>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {
namespace {

void append(std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>& frame) {
  bytes.insert(bytes.end(), frame.begin(), frame.end());
}

}  // namespace

GuardedRobot guarded_arcos() {
  GuardedRobot robot;
  append(robot.halt, encode_command(ArcosCommand::kStop));
  append(robot.halt, encode_command(ArcosCommand::kVelocity, 0));
  append(robot.halt, encode_command(ArcosCommand::kTurnRate, 0));
  append(robot.leave, encode_command(ArcosCommand::kEnable, 0));
  append(robot.leave, encode_command(ArcosCommand::kSonar, 0));
  append(robot.leave, encode_command(ArcosCommand::kClose));
  robot.hear_wheels = [parser = PacketParser()](std::span<const std::uint8_t> bytes) mutable {
    std::optional<bool> stand;
    parser.push(bytes);
    while (const auto packet = parser.next()) {
      if (const auto word =
              is_information(packet->type) ? decode_information(packet->type, packet->payload) : std::nullopt) {
        constexpr int kStandingSpeed = 20;  // [mm/s]
        stand = std::abs(word->left_mm_s) <= kStandingSpeed && std::abs(word->right_mm_s) <= kStandingSpeed;
      }
    }
    return stand;
  };
  return robot;
}

}  // namespace luminav
