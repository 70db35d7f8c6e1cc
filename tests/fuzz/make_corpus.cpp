#include <cstdio>
#include <filesystem>
#include <fstream>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

using namespace luminav;
using Bytes = std::vector<std::uint8_t>;

namespace {

void write(const std::filesystem::path& folder, int number, const Bytes& bytes) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / std::to_string(number), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

constexpr int kTenthWithCommand = 0x40 | (4 << 2) | 1;  // as the driver's fuzzer reads it: twice 50 ms
constexpr int kFiftieth = (2 << 2) | 1;                 // twice 10 ms

/// As the state machines' fuzzers read it: what goes by, type, length, payload.
void append_record(Bytes& to, int control, const Bytes& frame) {
  append(to, {static_cast<std::uint8_t>(control), frame[3], static_cast<std::uint8_t>(frame.size() - 6)});
  to.insert(to.end(), frame.begin() + 4, frame.end() - 2);
}

InformationPacket moving(int i) {
  InformationPacket packet;
  packet.moving = true;
  packet.x_mm = 30 * i;
  packet.heading = 20 * i;
  packet.left_mm_s = packet.right_mm_s = 300;
  packet.motors_enabled = true;
  packet.sonar = {{i % 8, 1000}, {8 + i % 8, 5000}};
  return packet;
}

}  // namespace

/// Seeds for the fuzzers: what robots and clients really say. make_arcos_corpus FOLDER
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_arcos_corpus FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  Bytes stream;
  Bytes robot = {1};
  for (int i = 0; i < 20; ++i) {
    const Bytes frame = encode_information(moving(i));
    append(stream, frame);
    append_record(robot, kTenthWithCommand, frame);
    write(folder / "fuzz_arcos_payloads", i, Bytes(frame.begin() + 3, frame.end() - 2));
  }
  write(folder / "fuzz_packet_parser", 0, stream);
  write(folder / "fuzz_p3dx_node", 0, robot);
  Bytes answers = {0};
  Bytes serial = {2};
  for (const Bytes& frame :
       {encode_packet(0), encode_packet(1), encode_identity({"a", "Pioneer", "p3dx-sh"}), encode_configuration({}),
        encode_information({}), encode_encoder({1, 2}), encode_input_output({{1, 2, 3, 4}, {5}, {6, 7}})}) {
    append_record(answers, kFiftieth, frame);
    append_record(serial, kFiftieth, frame);
    write(folder / "fuzz_arcos_payloads", 100 + static_cast<int>(frame[3]), Bytes(frame.begin() + 3, frame.end() - 2));
  }
  write(folder / "fuzz_p3dx_node", 1, answers);
  for (int i = 0; i < 3; ++i) {
    append_record(serial, 6 << 2, encode_information(moving(i)));  // at the new rate
  }
  write(folder / "fuzz_p3dx_node", 2, serial);
  Bytes client = {2};
  Bytes raw;
  int number = 0;
  for (const auto& [command, value] : {std::pair{ArcosCommand::kEnable, 1},
                                       {ArcosCommand::kSetAcceleration, 500},
                                       {ArcosCommand::kSetAcceleration, -900},
                                       {ArcosCommand::kVelocity, 300},
                                       {ArcosCommand::kHeading, -90},
                                       {ArcosCommand::kTurnRate, 30},
                                       {ArcosCommand::kTurnBy, 45},
                                       {ArcosCommand::kMove, -500},
                                       {ArcosCommand::kEncoder, 2},
                                       {ArcosCommand::kIoRequest, 1},
                                       {ArcosCommand::kSonar, 4},
                                       {ArcosCommand::kBumpStall, 3},
                                       {ArcosCommand::kHostBaud, 4},
                                       {ArcosCommand::kEmergencyStop, 0},
                                       {ArcosCommand::kConfiguration, 1},
                                       {ArcosCommand::kClose, 1}}) {
    const Bytes frame = encode_command(command, value);
    append_record(client, 15, frame);
    append(raw, frame);
    Bytes alone = {2};
    append_record(alone, 15, encode_command(ArcosCommand::kEnable, 1));
    append_record(alone, 15, frame);
    write(folder / "fuzz_arcos_controller", ++number, alone);
  }
  append_record(client, 15, encode_command(ArcosCommand::kPolling, "\x01\x08\x10"));
  append_record(client, 15, encode_wheel_velocities({-5, 5}));
  write(folder / "fuzz_arcos_controller", 0, client);
  write(folder / "fuzz_packet_parser", 1, raw);
  return 0;
}
