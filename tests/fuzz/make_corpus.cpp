#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "drivers/create2/oi/sensor_reading.hpp"
#include "drivers/create2/oi/stream_parser.hpp"
#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "tests/replay/log_reading/sample_message.hpp"

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

Bytes contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// With the byte that chooses the reader, as files_fuzzer.cpp lists them.
void write_file(const std::filesystem::path& folder, std::uint8_t reader, Bytes bytes) {
  constexpr std::size_t kMaxSize = 8000;
  bytes.insert(bytes.begin(), reader);
  bytes.resize(std::min(bytes.size(), kMaxSize));
  write(folder / "fuzz_files", reader, bytes);
}

void write_files(const std::filesystem::path& folder) {
  const std::filesystem::path launch = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch";
  const auto text = [](const std::string& words) { return Bytes(words.begin(), words.end()); };
  write_file(folder, 0, contents(launch / "robots/p3dx.toml"));
  write_file(folder, 1, contents(launch / "buildings/laboratory/building.toml"));
  write_file(folder, 2, contents(launch / "scenarios/laboratory-crowd.toml"));
  write_file(folder, 3,
             text("image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"));
  write_file(folder, 4, text("P5\n# by hand\n3 2\n255\nabcdef"));
  write_file(folder, 5, contents(launch / "demo.pmd"));
  write_file(folder, 8, text("building = \"room\"\nfixtures = 4\nsession = 2\n"));
  write_file(folder, 9, text("engaged 17 somebody\n"));
  write_file(folder, 10, contents(std::filesystem::path(LUMINAV_SOURCE_DIR) / "tests/replay/logs/global.lcm"));
  write_file(folder, 11,
             text(std::string("\0{\"poses\": [{\"x\": 1, \"y\": 2, \"theta\": 0.5}], \"loop\": true}", 59)));
  write_file(folder, 12, text("[network]\npeers = [\"10.0.0.2\"]\nkey = \"none\"\n"));
}

/// A sound message of every type; for the nodes, one of each without changes.
void write_messages(const std::filesystem::path& folder) {
  std::uint8_t number = 0;
  Bytes all;
  for (const auto& [name, type] : MessageSchemas::built_in().types()) {
    Bytes bytes = sample_message(MessageSchemas::built_in(), type);
    bytes.erase(bytes.begin(), bytes.begin() + 8);
    bytes.insert(bytes.begin(), number);
    write(folder / "fuzz_messages", number, bytes);
    append(all, {number, 0x40});
    ++number;
  }
  append(all, all);
  constexpr std::uint8_t kCasts = 7;  // of the fuzzer: each service alone, then all of them
  for (std::uint8_t cast = 0; cast < kCasts; ++cast) {
    Bytes run = {cast};
    append(run, all);
    write(folder / "fuzz_nodes", cast, run);
  }
}

void write_pictures(const std::filesystem::path& folder) {
  constexpr int kWidth = 96;  // [px] as the fuzzer's camera
  constexpr int kHeight = 72;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kWidth) * kHeight, 90);
  for (int row = 20; row < 32; ++row) {
    std::fill_n(pixels.begin() + row * kWidth + 20, 50, std::uint8_t{250});
  }
  JpegEncoder encoder;
  const auto jpeg = encoder.encode({kWidth, kHeight, pixels}, 85);
  Bytes picture = {0};
  picture.insert(picture.end(), jpeg.begin(), jpeg.end());
  write(folder / "fuzz_pictures", 0, picture);
  write(folder / "fuzz_pictures", 1, {1, 'P', '5', ' ', '2', ' ', '1', ' ', '2', '5', '5', '\n', 7, 9});
  write(folder / "fuzz_pictures", 2, {2, 90, 1, 20, 20, 50, 12, 250});
  write(folder / "fuzz_pictures", 3, {3, 90, 2, 20, 20, 50, 12, 250, 5, 40, 40, 10, 130});
}

}  // namespace

/// Seeds for the fuzzers: what robots and clients really say. make_corpus FOLDER
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_corpus FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  write_files(folder);
  write_messages(folder);
  write_pictures(folder);
  Bytes stream;
  Bytes robot = {1};
  for (int i = 0; i < 20; ++i) {
    const Bytes frame = encode_information(moving(i));
    append(stream, frame);
    append_record(robot, kTenthWithCommand, frame);
    write(folder / "fuzz_arcos_payloads", i, Bytes(frame.begin() + 3, frame.end() - 2));
  }
  write(folder / "fuzz_packet_parser", 0, stream);
  write(folder / "fuzz_oi_stream", 0, encode_stream_frame(encode_readings({}, wanted_readings())));
  write(folder / "fuzz_oi_stream", 1, encode_readings({}, wanted_readings()));
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
