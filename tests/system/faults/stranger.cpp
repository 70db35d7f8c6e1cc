#include "tests/system/faults/stranger.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <luminav/goal_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/teleop_command_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

#include "services/common/process/channels.hpp"
#include "tests/replay/log_reading/sample_message.hpp"

namespace luminav {
namespace {

constexpr std::uint16_t kDataPort = 7667;
constexpr std::uint16_t kProcmanPort = 7668;

void append(std::vector<std::uint8_t>& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

/// As LCM sends a message that fits a datagram.
std::vector<std::uint8_t> short_message(std::uint32_t sequence, const std::string& channel,
                                        const std::vector<std::uint8_t>& payload) {
  std::vector<std::uint8_t> datagram;
  append(datagram, "LC02");
  for (int shift = 24; shift >= 0; shift -= 8) {
    datagram.push_back(static_cast<std::uint8_t>(sequence >> shift));
  }
  append(datagram, channel);
  datagram.push_back(0);
  datagram.insert(datagram.end(), payload.begin(), payload.end());
  return datagram;
}

}  // namespace

Stranger::Stranger(const NetworkHost& machine, const std::string& robot_address) {
  const InsideHost inside(&machine);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const unsigned char ttl = 1;
  if (socket_ < 0 || setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl) != 0) {
    throw std::runtime_error("no socket for a stranger");
  }
  targets_.resize(2);
  inet_aton("239.255.76.67", &targets_[0]);
  inet_aton(robot_address.c_str(), &targets_[1]);
}

Stranger::~Stranger() {
  close(socket_);
}

void Stranger::send(std::uint16_t port, const std::vector<std::uint8_t>& datagram) {
  for (const in_addr& target : targets_) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr = target;
    address.sin_port = htons(port);
    sent_ +=
        sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&address), sizeof address) > 0
            ? 1
            : 0;
  }
}

void Stranger::say_bytes(const std::string& channel, const std::vector<std::uint8_t>& payload) {
  send(channel.starts_with("PM_") ? kProcmanPort : kDataPort, short_message(++sequence_, channel, payload));
}

template <typename Message>
void Stranger::say(const std::string& channel, const Message& message) {
  std::vector<std::uint8_t> payload(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  say_bytes(channel, payload);
}

const std::vector<Stranger::Order>& Stranger::orders() {
  static const std::vector<Order> kOrders = {{channels::kVelocityCommand, &Stranger::drive},
                                             {channels::kTeleopCommand, &Stranger::steer},
                                             {channels::kInitialPose, &Stranger::guess_pose},
                                             {channels::kMapCommand, &Stranger::save_map},
                                             {channels::kJob, &Stranger::ask_for_job},
                                             {channels::kGoal, &Stranger::set_goal},
                                             {channels::kStop, &Stranger::release_stop},
                                             {channels::kMotorsCommand, &Stranger::disable_motors},
                                             {channels::kProcmanOrders, &Stranger::order_processes}};
  return kOrders;
}

void Stranger::command_everything(std::int64_t utime) {
  for (const Order& order : orders()) {
    give(order, utime);
  }
}

void Stranger::drive(std::int64_t utime) {
  say(channels::kVelocityCommand, velocity_command_t{.utime = utime,
                                                     .robot = "p3dx",
                                                     .session = utime - 100'000,
                                                     .sequence = static_cast<std::int32_t>(sequence_),
                                                     .linear_x = 0.5,
                                                     .linear_y = 0.0,
                                                     .angular_z = 0.0});
}

void Stranger::steer(std::int64_t utime) {
  say(channels::kTeleopCommand, teleop_command_t{.utime = utime,
                                                 .session = utime - 100'000,
                                                 .sequence = static_cast<std::int32_t>(sequence_),
                                                 .linear = 0.5,
                                                 .angular = 0.0});
}

void Stranger::set_goal(std::int64_t utime) {
  goal_t goal{};
  goal.utime = goal.id = utime;
  goal.action = goal_t::ACTION_GO;
  goal.count = 1;
  goal.poses.resize(1);
  goal.poses[0].x = 8.0;
  goal.poses[0].y = 6.0;
  say(channels::kGoal, goal);
}

void Stranger::ask_for_job(std::int64_t utime) {
  job_t job{};
  job.utime = job.id = utime;
  job.action = job_t::ACTION_ADD;
  job.kind = job_t::KIND_GO;
  job.count = 1;
  job.stops.resize(1);
  job.stops[0].x = 8.0;
  job.stops[0].y = 6.0;
  job.sender = "stranger";
  say(channels::kJob, job);
}

void Stranger::release_stop(std::int64_t utime) {
  stop_t release{};
  release.utime = release.id = utime;
  release.sender = "stranger";
  say(channels::kStop, release);
}

void Stranger::disable_motors(std::int64_t utime) {
  motors_command_t motors{};
  motors.utime = motors.id = utime;
  say(channels::kMotorsCommand, motors);
}

void Stranger::guess_pose(std::int64_t utime) {
  initial_pose_t pose{};
  pose.utime = pose.id = utime;
  pose.covariance[0] = pose.covariance[4] = pose.covariance[8] = 0.01;
  say(channels::kInitialPose, pose);
}

void Stranger::save_map(std::int64_t utime) {
  map_command_t map{};
  map.utime = map.id = utime;
  map.action = map_command_t::ACTION_SAVE;
  map.path = "intruder";
  say(channels::kMapCommand, map);
}

void Stranger::order_processes(std::int64_t utime) {
  luminav_procman::procman_orders_t orders{};
  orders.utime = utime;
  orders.deputy_id = "robot";
  orders.sheriff_id = "stranger:1:" + std::to_string(utime);  // who started last is in command
  say(channels::kProcmanOrders, orders);
}

void Stranger::engage_stop(std::int64_t utime) {
  stop_t stop{};
  stop.utime = stop.id = utime;
  stop.engaged = 1;
  stop.sender = "stranger";
  say(channels::kStop, stop);
}

void Stranger::send_every_type() {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  for (const auto& [name, type] : schemas.types()) {
    const std::string channel = name == "procman_orders_t"        ? channels::kProcmanOrders
                                : name == "procman_deputy_info_t" ? channels::kProcmanInfo
                                : name == "procman_output_t"      ? channels::kProcmanOutput
                                : name == "procman_discovery_t"   ? channels::kProcmanDiscover
                                                                  : sample_channel(type);
    if (name == "stop_t") {
      continue;  // the sample engages
    }
    say_bytes(channel, sample_message(schemas, type));
    for (const std::int64_t number : {std::int64_t{-1}, std::int64_t{1} << 26, std::int64_t{0x20000000},
                                      std::int64_t{0x3fffffff}, std::numeric_limits<std::int64_t>::max()}) {
      for (const FieldSchema& field : type.fields) {
        say_bytes(channel, sample_message(schemas, type, {{field.name, number}}));
      }
    }
  }
}

void Stranger::send_rubbish(int datagrams) {
  std::vector<std::vector<std::uint8_t>> rubbish(static_cast<std::size_t>(datagrams));
  for (int i = 0; i < datagrams; ++i) {
    std::vector<std::uint8_t>& bytes = rubbish[static_cast<std::size_t>(i)];
    bytes.resize(rng_() % 1200);
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::uint8_t>(rng_()); });
    if (i % 3 == 0) {
      bytes = short_message(++sequence_, i % 2 == 0 ? channels::kPose : channels::kGridTile, bytes);
    } else if (i % 3 == 1 && bytes.size() > 20) {
      std::copy_n("LC03", 4, bytes.begin());
    }
  }
  for (const in_addr& target : targets_) {
    for (const std::uint16_t port : {kDataPort, kProcmanPort}) {
      send_together(rubbish, {.sin_family = AF_INET, .sin_port = htons(port), .sin_addr = target, .sin_zero = {}});
    }
  }
}

void Stranger::send_together(std::vector<std::vector<std::uint8_t>>& datagrams, sockaddr_in address) {
  std::vector<iovec> parts(datagrams.size());
  std::vector<mmsghdr> messages(datagrams.size());
  for (std::size_t i = 0; i < datagrams.size(); ++i) {
    parts[i] = {datagrams[i].data(), datagrams[i].size()};
    messages[i].msg_hdr = {.msg_name = &address,
                           .msg_namelen = sizeof address,
                           .msg_iov = &parts[i],
                           .msg_iovlen = 1,
                           .msg_control = nullptr,
                           .msg_controllen = 0,
                           .msg_flags = 0};
  }
  for (std::size_t done = 0; done < messages.size();) {
    const int count = sendmmsg(socket_, &messages[done], static_cast<unsigned>(messages.size() - done), 0);
    if (count <= 0) {
      return;
    }
    sent_ += count;
    done += static_cast<std::size_t>(count);
  }
}

}  // namespace luminav
