// One-way latency from the call of publish to the entry of the handler, between two processes on one host: bare LCM,
// LCM through our Subscriber, and raw UDP multicast beside them. Wall clock; 1,000 messages a second. Needs multicast
// on the loopback interface: run it as `tests/system/in_namespace build/bin/bench_lcm`.
#include <arpa/inet.h>
#include <benchmark/benchmark.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/pose_t.hpp>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

constexpr int kMessages = 3000;
constexpr const char* kUrl = "udpm://239.255.76.67:7689?ttl=0&recv_buf_size=2097152";
constexpr std::uint16_t kRawPort = 7690;
constexpr const char* kGroup = "239.255.76.68";

std::int64_t nanoseconds_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// What the receiving process tells the sending one, in memory that both share.
struct Arrival {
  std::atomic<bool> is_listening{false};
  std::atomic<std::int64_t> count{0};
  std::atomic<std::int64_t> when{0};  // [ns] of the last one
};

class SharedArrival {
 public:
  SharedArrival() : memory_(mmap(nullptr, sizeof(Arrival), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) {
      throw std::runtime_error("no shared memory");
    }
    arrival_ = new (memory_) Arrival;
  }
  ~SharedArrival() { munmap(memory_, sizeof(Arrival)); }
  SharedArrival(const SharedArrival&) = delete;
  SharedArrival& operator=(const SharedArrival&) = delete;
  Arrival& operator*() const { return *arrival_; }

 private:
  void* memory_;
  Arrival* arrival_ = nullptr;
};

/// A process that listens until it is ended.
class ListeningProcess {
 public:
  explicit ListeningProcess(const std::function<void()>& listen) : pid_(fork()) {
    if (pid_ == 0) {
      listen();
      _exit(0);
    }
  }
  ~ListeningProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  ListeningProcess(const ListeningProcess&) = delete;
  ListeningProcess& operator=(const ListeningProcess&) = delete;

 private:
  pid_t pid_;
};

void note(Arrival& arrival) {
  arrival.when.store(nanoseconds_now());
  arrival.count.fetch_add(1);
}

struct BareListener {
  Arrival* arrival = nullptr;
  void on_bytes(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/) { note(*arrival); }
};

template <typename Message>
struct NodeListener {
  Arrival* arrival = nullptr;
  void on_message(const Message& /*message*/) { note(*arrival); }
};

void listen_bare(Arrival& arrival) {
  lcm::LCM lcm(kUrl);
  BareListener listener{&arrival};
  lcm.subscribe("BENCH", &BareListener::on_bytes, &listener);
  arrival.is_listening = true;
  while (lcm.handle() == 0) {
  }
}

template <typename Message>
void listen_as_node(Arrival& arrival) {
  lcm::LCM lcm(kUrl);
  NodeListener<Message> listener{&arrival};
  Subscriber subscriber(lcm);
  subscriber.on("BENCH", &NodeListener<Message>::on_message, &listener);
  arrival.is_listening = true;
  while (lcm.handle() == 0) {
  }
}

sockaddr_in raw_address() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kRawPort);
  inet_pton(AF_INET, kGroup, &address.sin_addr);
  return address;
}

void listen_raw(Arrival& arrival) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address = raw_address();
  bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  ip_mreq group{address.sin_addr, {htonl(INADDR_ANY)}};
  setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group));
  arrival.is_listening = true;
  std::vector<char> bytes(65536);
  while (recv(descriptor, bytes.data(), bytes.size(), 0) > 0) {
    note(arrival);
  }
}

/// Sends one message per iteration and reports how long each took to arrive: the mean as the benchmark's time, median
/// and 99th percentile [us] as counters. A message that does not arrive within 0.1 s is counted as lost.
void measure(benchmark::State& state, const std::function<void(Arrival&)>& listen, const std::function<void()>& send) {
  const SharedArrival arrival;
  const ListeningProcess listener([&] { listen(*arrival); });
  while (!(*arrival).is_listening) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::vector<double> latencies;
  int lost = 0;
  for (auto _ : state) {
    const std::int64_t before = (*arrival).count;
    const std::int64_t sent = nanoseconds_now();
    send();
    while ((*arrival).count == before && nanoseconds_now() - sent < 100'000'000) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    if ((*arrival).count == before) {
      ++lost;
      state.SetIterationTime(0.1);
      continue;
    }
    latencies.push_back(1e-3 * static_cast<double>((*arrival).when - sent));
    state.SetIterationTime(1e-6 * latencies.back());
    std::this_thread::sleep_for(std::chrono::microseconds(800));
  }
  if (latencies.empty()) {
    state.SkipWithError("nothing arrived: is there a multicast route?");
    return;
  }
  std::sort(latencies.begin(), latencies.end());
  state.counters["p50_us"] = latencies[latencies.size() / 2];
  state.counters["p99_us"] = latencies[latencies.size() * 99 / 100];
  state.counters["lost"] = lost;
}

/// About 300 bytes on the wire.
pose_t small_message() {
  pose_t pose{};
  pose.utime = 1;  // what has none is dropped
  pose.reason = "one pose explains all that was seen on the last 12 m of the way, no other";
  return pose;
}

camera_image_t large_message() {
  camera_image_t image{};
  image.utime = 1;
  image.data.resize(30'000);
  image.size = static_cast<std::int32_t>(image.data.size());
  return image;
}

template <typename Message>
void lcm_bare(benchmark::State& state, const Message& message) {
  lcm::LCM lcm(kUrl);
  measure(state, listen_bare, [&] { lcm.publish("BENCH", &message); });
  state.counters["bytes"] = message.getEncodedSize();
}

template <typename Message>
void lcm_node(benchmark::State& state, const Message& message) {
  lcm::LCM lcm(kUrl);
  measure(state, listen_as_node<Message>, [&] { lcm.publish("BENCH", &message); });
}

void udp_multicast(benchmark::State& state) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  const unsigned char hops = 0;
  setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof(hops));
  const sockaddr_in address = raw_address();
  const std::vector<char> bytes(static_cast<std::size_t>(state.range(0)));
  measure(state, listen_raw, [&] {
    sendto(descriptor, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  });
  close(descriptor);
}

template <typename Message>
void encode(benchmark::State& state, const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  for (auto _ : state) {
    benchmark::DoNotOptimize(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())));
    benchmark::ClobberMemory();
  }
}

template <typename Message>
void decode(benchmark::State& state, const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  for (auto _ : state) {
    Message decoded{};
    benchmark::DoNotOptimize(decoded.decode(bytes.data(), 0, static_cast<int>(bytes.size())));
  }
}

BENCHMARK_CAPTURE(lcm_bare, 300, small_message())->Name("lcm/300")->Iterations(kMessages)->UseManualTime();
BENCHMARK_CAPTURE(lcm_bare, 30000, large_message())->Name("lcm/30000")->Iterations(kMessages)->UseManualTime();
BENCHMARK_CAPTURE(lcm_node, 300, small_message())->Name("lcm_node/300")->Iterations(kMessages)->UseManualTime();
BENCHMARK_CAPTURE(lcm_node, 30000, large_message())->Name("lcm_node/30000")->Iterations(kMessages)->UseManualTime();
BENCHMARK(udp_multicast)->Arg(300)->Arg(30000)->Iterations(kMessages)->UseManualTime();
BENCHMARK_CAPTURE(encode, 300, small_message())->Name("encode/300");
BENCHMARK_CAPTURE(encode, 30000, large_message())->Name("encode/30000");
BENCHMARK_CAPTURE(decode, 300, small_message())->Name("decode/300");
BENCHMARK_CAPTURE(decode, 30000, large_message())->Name("decode/30000");

}  // namespace
}  // namespace luminav

BENCHMARK_MAIN();
