#include <benchmark/benchmark.h>

#include <lcm/lcm-cpp.hpp>
#include <random>
#include <vector>

#include "drivers/p3dx/arcos_commands.hpp"
#include "drivers/p3dx/arcos_packet.hpp"
#include "drivers/p3dx/information_packet.hpp"
#include "tests/node/p3dx/p3dx_bench.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t kStream = 1 << 20;  // [bytes]
constexpr std::size_t kChunk = 4096;      // [bytes] as one read gives

Bytes clean_stream() {
  InformationPacket packet;
  for (int disc = 0; disc < 16; ++disc) {
    packet.sonar.push_back({disc, 1000 + disc});
  }
  Bytes stream;
  while (stream.size() < kStream) {
    packet.x_mm += 30;
    const Bytes frame = encode_information(packet);
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  return stream;
}

Bytes random_bytes() {
  std::mt19937 rng(1);
  Bytes stream(kStream);
  for (std::uint8_t& byte : stream) {
    byte = static_cast<std::uint8_t>(rng());
  }
  return stream;
}

/// The worst there is: every other byte begins a header that claims 250 bytes.
Bytes false_headers() {
  Bytes stream(kStream);
  for (std::size_t i = 0; i < stream.size(); ++i) {
    stream[i] = i % 2 == 0 ? 0xFA : 0xFB;
  }
  return stream;
}

void parse(benchmark::State& state, const Bytes& stream) {
  std::int64_t packets = 0;
  for (auto _ : state) {
    PacketParser parser;
    for (std::size_t i = 0; i < stream.size(); i += kChunk) {
      parser.push(std::span(stream).subspan(i, std::min(kChunk, stream.size() - i)));
      while (const auto packet = parser.next()) {
        benchmark::DoNotOptimize(packet->payload.data());
        ++packets;
      }
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * stream.size()));
  state.counters["packets"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(parse, clean, clean_stream());
BENCHMARK_CAPTURE(parse, random, random_bytes());
BENCHMARK_CAPTURE(parse, false_headers, false_headers());

void decode_and_parse(benchmark::State& state) {
  const Bytes stream = clean_stream();
  for (auto _ : state) {
    PacketParser parser;
    for (std::size_t i = 0; i < stream.size(); i += kChunk) {
      parser.push(std::span(stream).subspan(i, std::min(kChunk, stream.size() - i)));
      while (const auto packet = parser.next()) {
        benchmark::DoNotOptimize(decode_information(packet->type, packet->payload));
      }
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * stream.size()));
}
BENCHMARK(decode_and_parse);

/// One second of driver and simulated controller together in virtual time, commanded at 50 Hz.
void one_robot_second(benchmark::State& state) {
  P3dxBench bench;
  bench.drive(0.3, 0.1);
  bench.run(5.0);
  for (auto _ : state) {
    bench.run(1.0);
    bench.odometry.clear();
    bench.sonar.clear();
    bench.status.clear();
  }
}
BENCHMARK(one_robot_second)->Unit(benchmark::kMillisecond);

/// From a VELOCITY_COMMAND in the driver's hands to its bytes on the line.
void command_to_bytes(benchmark::State& state) {
  P3dxBench bench;
  bench.run(3.0);
  std::int32_t sequence = 0;
  for (auto _ : state) {
    state.PauseTiming();
    bench.run(0.02);
    ++sequence;
    bench.send_command(bench.clock.utime(), 1, sequence, sequence % 2 == 0 ? 0.1 : 0.2, 0.1);
    state.ResumeTiming();
    bench.lcm.handleTimeout(0);
  }
}
BENCHMARK(command_to_bytes)->Iterations(5000);

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
