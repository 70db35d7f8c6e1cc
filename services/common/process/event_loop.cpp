#include "services/common/process/event_loop.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <luminav/node_status_t.hpp>
#include <stdexcept>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/network/lcm_network.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/command_line.hpp"

namespace luminav {
namespace {

constexpr std::size_t kNodeMemory = 512;        // [MB] the largest of ours uses a tenth of it
constexpr std::int64_t kDeafAfter = 3'500'000;  // [us] three of its own messages were not heard
constexpr std::int64_t kHealthPeriod = 50'000;  // [us]
constexpr std::int64_t kHealthSlack = 25'000;   // [us]

int g_signal_pipe[2] = {-1, -1};

void on_signal(int) {
  const char byte = 1;
  [[maybe_unused]] const ssize_t written = write(g_signal_pipe[1], &byte, 1);
}

std::int64_t now_monotonic() {
  return read_clock(CLOCK_MONOTONIC);
}

std::int8_t state_of(const Health& health) {
  return health.fault      ? node_status_t::STATE_FAULT
         : health.degraded ? node_status_t::STATE_DEGRADED
                           : node_status_t::STATE_READY;
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Asks the kernel before LCM does, which would say it in the words of tools that Debian has no more.
bool has_route(const MulticastAddress& group) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = group.group;
  address.sin_port = htons(group.port);
  const bool reached = connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(descriptor);
  return reached;
}

void check_url(const std::string& url) {
  const auto multicast = multicast_address(url);
  const auto starts_with = [&](const char* scheme) { return url.starts_with(scheme); };
  if (!multicast && !starts_with("memq://") && !starts_with("file://") && !starts_with("tcpq://") &&
      !starts_with("mpudpm://")) {
    throw ConfigurationError(fmt::format(
        "the LCM network is {}, must be udpm://GROUP:PORT?ttl=N, as udpm://239.255.76.67:7667?ttl=0 (LUMINAV_LCM_URL, "
        "LCM_DEFAULT_URL or --lcm-url)",
        url));
  }
  if (multicast && !has_route(*multicast)) {
    throw std::runtime_error(
        fmt::format("no route for multicast to the LCM network {}; on one machine "
                    "`sudo ip link set lo multicast on; sudo ip route add 224.0.0.0/4 dev lo` makes one",
                    url));
  }
}

}  // namespace

std::unique_ptr<lcm::LCM> open_lcm(const LcmNetwork& network) {
  check_url(network.url);
  std::string full = network.url;
  if (full.starts_with("udpm://") && full.find("recv_buf_size") == std::string::npos) {
    // Stock Debian caps this at 212,992 (425,984 effective), which holds seven of the largest messages.
    full += (full.find('?') == std::string::npos ? "?" : "&") + std::string("recv_buf_size=2097152");
  }
  auto lcm = std::make_unique<lcm::LCM>(full);
  if (!lcm->good()) {
    throw std::runtime_error(fmt::format("cannot open the LCM network {}", network.url));
  }
  receive_from_peers_only(*lcm, network);
  return lcm;
}

void limit_memory([[maybe_unused]] std::size_t megabytes) {
#ifndef LUMINAV_SANITIZED  // shadow memory counts
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) == 0) {
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, megabytes << 20);
    setrlimit(RLIMIT_DATA, &limit);
  }
#endif
}

EventLoop::EventLoop(lcm::LCM& lcm, std::string process, std::string robot, LcmNetwork network)
    : lcm_(lcm),
      network_(std::move(network)),
      self_{std::move(process), std::move(robot), host_name(), read_clock(CLOCK_REALTIME)},
      roles_(self_.robot),
      heard_itself_(now_monotonic()),
      subscriber_(lcm) {
  subscriber_.on(channels::kNodeStatus, &EventLoop::on_node_status, this);
  limit_memory(kNodeMemory);
  if (g_signal_pipe[0] < 0 && pipe2(g_signal_pipe, O_CLOEXEC | O_NONBLOCK) != 0) {
    throw std::runtime_error("cannot make a pipe for signals");
  }
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
  every(
      1'000'000, [this] { publish_status(); }, kHealthSlack);
  every(1'000'000, [this] { listen_to_itself(); });
  every(
      kHealthPeriod, [this] { check_health(); }, kHealthSlack);
}

EventLoop::~EventLoop() = default;

void EventLoop::watch(std::function<int()> descriptor, std::function<void()> on_readable) {
  watches_.push_back({std::move(descriptor), std::move(on_readable)});
}

void EventLoop::every(std::int64_t period, std::function<void()> callback, std::int64_t slack) {
  timers_.push_back({period, now_monotonic(), std::move(callback), slack});
}

void EventLoop::when_due(std::function<std::optional<std::int64_t>()> left, std::function<void()> callback) {
  deadlines_.push_back({std::move(left), std::move(callback)});
}

void EventLoop::run_due_timers() {
  for (std::size_t i = 0; i < timers_.size(); ++i) {
    const std::int64_t now = now_monotonic();
    Timer& timer = timers_[i];
    if (now < timer.due - timer.slack) {
      continue;
    }
    const std::int64_t missed = std::max<std::int64_t>(0, now - timer.due) / timer.period;
    timer.due += (missed + 1) * timer.period;
    load_.measure(timer.callback);
  }
  for (const Deadline& deadline : deadlines_) {
    if (deadline.left().value_or(1) <= 0) {
      load_.measure(deadline.callback);
    }
  }
}

std::int64_t EventLoop::microseconds_to_next_timer() const {
  const std::int64_t now = now_monotonic();
  std::int64_t left = 1'000'000;
  for (const Timer& timer : timers_) {
    left = std::min(left, timer.due - now);
  }
  for (const Deadline& deadline : deadlines_) {
    left = std::min(left, deadline.left().value_or(left));
  }
  return std::max<std::int64_t>(0, left);
}

void EventLoop::wait_for_descriptors() {
  descriptors_.assign({{lcm_.getFileno(), POLLIN, 0}, {g_signal_pipe[0], POLLIN, 0}});
  for (const Watch& watch : watches_) {
    descriptors_.push_back({watch.descriptor(), POLLIN, 0});
  }
  const std::int64_t left = microseconds_to_next_timer();
  const timespec wait{left / 1'000'000, left % 1'000'000 * 1000};
  if (ppoll(descriptors_.data(), descriptors_.size(), &wait, nullptr) < 0 && errno != EINTR) {
    throw std::runtime_error("poll failed");
  }
}

int EventLoop::run() {
  while (!stopping_) {
    run_due_timers();
    wait_for_descriptors();
    if (descriptors_[1].revents != 0) {
      std::array<char, 64> bytes{};
      [[maybe_unused]] const ssize_t count = read(g_signal_pipe[0], bytes.data(), bytes.size());
      break;
    }
    if (descriptors_[0].revents != 0) {
      // One message at a time, so that a flood of them cannot starve the device and the timers.
      int status = 0;
      load_.measure([&] { status = lcm_.handle(); });
      if (status < 0 && errno != EINTR) {
        return 1;
      }
    }
    for (std::size_t i = 0; i < watches_.size() && !stopping_; ++i) {
      if (descriptors_[i + 2].revents != 0) {
        load_.measure(watches_[i].on_readable);
      }
    }
  }
  return 0;
}

void EventLoop::check_health() {
  if (state_of(current_health()) != published_state_) {
    publish_status();  // who waits for this process need not wait for the second to pass
  }
}

void EventLoop::belong_to(const std::filesystem::path& robot_file) {
  given_.set_robot(robot_file);
}

void EventLoop::follow_building(const std::filesystem::path& file, std::function<void(const Building&)> take) {
  if (!file.empty()) {
    given_.follow_building(file, std::move(take));
  }
}

void EventLoop::building_has_changed() {
  if (given_.take_over()) {
    publish_status();
  }
}

void EventLoop::on_node_status(const node_status_t& status) {
  const std::int64_t now = now_monotonic();
  if (given_.take_over(status.building_hash)) {
    publish_status();  // else the others would take this one for one with another building, for a second
  }
  others_.hear(status, now);
  roles_.hear(status, now);
  if (self_.has_said(status)) {
    heard_itself_ = now;
  }
}

std::string EventLoop::objection() const {
  return others_.objection(given_.files(), now_monotonic());
}

Health EventLoop::current_health() const {
  Health health = health_ ? health_() : Health{};
  const std::string twins = roles_.conflict_of(self_.process, now_monotonic());
  if (!twins.empty()) {
    health.fault = true;
    health.reason = twins;
  } else if (std::string other = objection(); !other.empty()) {
    health.fault = true;
    health.reason = std::move(other);
  } else if (is_deaf() && !health.fault) {
    health.degraded = true;
    health.reason = "hears not even itself on the network: its interface is gone";
  }
  return health;
}

bool EventLoop::is_deaf() const {
  return now_monotonic() - heard_itself_ > kDeafAfter;
}

void EventLoop::listen_to_itself() {
  if (is_deaf()) {
    join_again(network_);
  }
}

std::string EventLoop::conflict() const {
  return roles_.conflict(now_monotonic());
}

void EventLoop::publish_status() {
  const Health health = current_health();
  node_status_t status{};
  status.utime = read_clock(CLOCK_REALTIME);
  self_.sign(status);
  status.building = given_.files().building;
  status.building_hash = given_.files().building_hash;
  status.robot_hash = given_.files().robot_hash;
  status.version = kVersion;
  published_state_ = status.state = state_of(health);
  status.reason = health.reason;
  status.dropped_inputs = health.dropped_inputs;
  load_.report(status);
  lcm_.publish(channels::kNodeStatus, &status);
}

}  // namespace luminav
