#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/system/faults/hosts/network_host.hpp"

namespace luminav {

/// Somebody on another machine who knows LCM's wire and all our types, but has no key.
class Stranger {
 public:
  /// Speaks from that machine to the group and straight to the robot's address.
  Stranger(const NetworkHost& machine, const std::string& robot_address);
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  ~Stranger();

  /// A message that might move, change, stop or kill something.
  struct Order {
    std::string channel;
    void (Stranger::*give)(std::int64_t utime);
  };
  /// All of them. Stopping the robot is left out: that is everybody's right.
  static const std::vector<Order>& orders();
  /// Gives an order by multicast and by unicast, as if it answered messages stamped `utime` [us].
  void give(const Order& order, std::int64_t utime) { (this->*order.give)(utime); }
  /// Gives all orders.
  void command_everything(std::int64_t utime);
  /// Asks the robot to stand.
  void engage_stop(std::int64_t utime);
  /// Every type, whole and with hostile counts and stamps.
  void send_every_type();
  /// Datagrams without any sense, some of them with a good beginning, to each port of each target, as fast as they go.
  void send_rubbish(int datagrams);
  [[nodiscard]] std::int64_t sent() const { return sent_; }

 private:
  void drive(std::int64_t utime);
  void steer(std::int64_t utime);
  void ask_for_job(std::int64_t utime);
  void set_goal(std::int64_t utime);
  void release_stop(std::int64_t utime);
  void disable_motors(std::int64_t utime);
  void guess_pose(std::int64_t utime);
  void save_map(std::int64_t utime);
  void order_processes(std::int64_t utime);
  template <typename Message>
  void say(const std::string& channel, const Message& message);
  void say_bytes(const std::string& channel, const std::vector<std::uint8_t>& payload);
  void send(std::uint16_t port, const std::vector<std::uint8_t>& datagram);
  void send_together(std::vector<std::vector<std::uint8_t>>& datagrams, sockaddr_in address);

  int socket_ = -1;
  std::vector<in_addr> targets_;
  std::uint32_t sequence_ = 0;
  std::int64_t sent_ = 0;
  std::mt19937 rng_{42};
};

}  // namespace luminav
