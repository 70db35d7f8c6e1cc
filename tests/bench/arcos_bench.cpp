#include <benchmark/benchmark.h>
#include <poll.h>
#include <sys/time.h>

#include <algorithm>
#include <atomic>
#include <lcm/lcm-cpp.hpp>
#include <random>
#include <thread>
#include <vector>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"
#include "drivers/simulator/board_server.hpp"
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

BENCHMARK_CAPTURE(parse, clean, clean_stream())->Name("arcos/parse");
BENCHMARK_CAPTURE(parse, random, random_bytes())->Name("arcos/parse_noise");
BENCHMARK_CAPTURE(parse, false_headers, false_headers())->Name("arcos/parse_false_headers");

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
BENCHMARK(decode_and_parse)->Name("arcos/parse_and_decode");

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
BENCHMARK(one_robot_second)->Name("arcos/robot_second")->Unit(benchmark::kMillisecond);

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
BENCHMARK(command_to_bytes)->Name("arcos/command_to_bytes")->Iterations(5000);

constexpr const char* kMulticast = "udpm://239.255.76.67:7655?ttl=0";

std::int64_t wall_utime() {
  timeval now{};
  gettimeofday(&now, nullptr);  // as LCM stamps what it receives
  return std::int64_t{1'000'000} * now.tv_sec + now.tv_usec;
}

/// Keeps when a velocity left last, and which.
struct LastVelocity {
  std::int64_t utime = 0;  // [us]
  int mm_s = 0;
};

/// The driver's TCP connection, and an eye on it.
class WatchedStream final : public ByteStream {
 public:
  WatchedStream(std::unique_ptr<ByteStream> line, LastVelocity& last) : line_(std::move(line)), last_(last) {}
  std::size_t read(std::span<std::uint8_t> bytes) override { return line_->read(bytes); }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t count = line_->write(bytes);
    parser_.push(bytes.first(count));
    while (const auto packet = parser_.next()) {
      if (packet->type == static_cast<std::uint8_t>(ArcosCommand::kVelocity)) {
        last_ = {wall_utime(), decode_argument(packet->payload).value};
      }
    }
    return count;
  }
  [[nodiscard]] int descriptor() const override { return line_->descriptor(); }
  [[nodiscard]] bool is_open() const override { return line_->is_open(); }
  void close() override { line_->close(); }

 private:
  std::unique_ptr<ByteStream> line_;
  LastVelocity& last_;
  PacketParser parser_;
};

/// A simulated robot on TCP, in real time and a thread of its own.
class RobotThread {
 public:
  RobotThread() : server_(BoardServer::on_tcp(base_.controller(), 0)), device_(server_->address()) {
    thread_ = std::thread([this] {
      const HostClock clock;
      std::int64_t next = clock.utime();
      while (!stop_) {
        for (; clock.utime() >= next; next += 10'000) {
          base_.step(nullptr, false);
        }
        server_->poll();
        poll(nullptr, 0, 2);
      }
    });
  }
  ~RobotThread() {
    stop_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& device() const { return device_; }

 private:
  SimulatedBase base_;
  std::unique_ptr<BoardServer> server_;
  std::string device_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// Answers each ROBOT_STATUS with another velocity, from a thread of its own, as a controller's process would.
class CommanderThread {
 public:
  CommanderThread() : inbox_(lcm_) {
    inbox_.on(channels::kRobotStatus, &CommanderThread::on_status, this);
    thread_ = std::thread([this] {
      while (!stop_) {
        lcm_.handleTimeout(100);
      }
    });
  }
  ~CommanderThread() {
    stop_ = true;
    thread_.join();
  }

 private:
  void on_status(const robot_status_t& message) {
    velocity_command_t command{};
    command.utime = message.utime;
    command.robot = message.robot;
    command.session = 1;
    command.sequence = ++sequence_;
    command.linear_x = 0.001 * (100 + sequence_ % 100);
    command.angular_z = 0.01 * (sequence_ % 10);
    lcm_.publish(channels::kVelocityCommand, &command);
  }
  lcm::LCM lcm_{kMulticast};
  Subscriber inbox_;
  std::int32_t sequence_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// Keeps when LCM took the last command from its socket. To be subscribed before the driver, and so called before it.
struct Arrival {
  void on_command(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) { utime = buffer->recv_utime; }
  std::int64_t utime = 0;  // [us]
};

double percentile(std::vector<double>& values, double share) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// From a VELOCITY_COMMAND off the multicast socket to its VEL on the TCP connection, with the driver in a loop as in
/// its process and a commander that asks for another velocity at 50 Hz. The time of an iteration is that latency.
void command_over_multicast_to_tcp(benchmark::State& state) {
  lcm::LCM lcm(kMulticast);
  if (!lcm.good()) {
    state.SkipWithError("no multicast here: run it by tests/system/in_namespace");
    return;
  }
  RobotThread robot;
  LastVelocity written;
  Arrival arrival;
  lcm.subscribe(channels::kVelocityCommand, &Arrival::on_command, &arrival);
  const HostClock clock;
  P3dxNode node(lcm, P3dxBench::robot_config(), clock, [&, open = stream_opener(robot.device(), 9600)] {
    return std::make_unique<WatchedStream>(open(), written);
  });
  const CommanderThread commander;
  std::int64_t next_poll = clock.utime();
  Arrival last_arrival;
  const auto turn = [&] {
    std::array<pollfd, 2> descriptors{{{lcm.getFileno(), POLLIN, 0}, {node.descriptor(), POLLIN, 0}}};
    poll(descriptors.data(), descriptors.size(),
         static_cast<int>(std::clamp<std::int64_t>((next_poll - clock.utime() + 999) / 1000, 0, 10)));
    while (lcm.handleTimeout(0) > 0) {
    }
    if (descriptors[1].revents != 0 || clock.utime() >= next_poll) {
      node.poll();
      next_poll = clock.utime() + 10'000;
    }
  };
  const std::int64_t begun = clock.utime();
  while (written.mm_s == 0) {
    turn();  // connects, and obeys for the first time
    if (clock.utime() - begun > 10'000'000) {
      state.SkipWithError("the driver obeys no command");
      return;
    }
  }
  std::vector<double> latencies;  // [us]
  for (auto _ : state) {
    const int before = written.mm_s;  // each command asks for another
    while (arrival.utime == last_arrival.utime || written.mm_s == before || written.utime < arrival.utime) {
      turn();
    }
    last_arrival = arrival;
    latencies.push_back(static_cast<double>(written.utime - arrival.utime));
    state.SetIterationTime(1e-6 * latencies.back());
  }
  state.counters["p50_us"] = percentile(latencies, 0.5);
  state.counters["p99_us"] = percentile(latencies, 0.99);
}
BENCHMARK(command_over_multicast_to_tcp)
    ->Name("arcos/command_over_lcm")
    ->Iterations(500)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
