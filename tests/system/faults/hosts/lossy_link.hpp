#pragma once

#include <atomic>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace luminav {

struct LossyLinkParams {
  double loss = 0.0;       // share of messages that vanish, each way
  double duplicate = 0.0;  // share that comes twice
  double delay = 0.0;      // [s] least
  double jitter = 0.0;     // [s] up to so much longer: messages overtake each other
  std::uint64_t seed = 1;
};

/// Joins two LCM networks (two ports of 239.255.76.67 on this machine) as a bad radio link would: forwards each
/// datagram either way, or loses it, late, twice or out of order. Works from construction to destruction, in a thread
/// of its own.
class LossyLink {
 public:
  /// `local` channels stay on their side. Throws std::runtime_error without a route for multicast.
  LossyLink(int one_port, int other_port, const LossyLinkParams& params, std::set<std::string> local);
  LossyLink(const LossyLink&) = delete;
  LossyLink& operator=(const LossyLink&) = delete;
  ~LossyLink();

  [[nodiscard]] std::int64_t forwarded() const { return forwarded_; }
  [[nodiscard]] std::int64_t lost() const { return lost_; }

 private:
  struct Side {
    int port = 0;
    int receiver = -1;
    int sender = -1;
    int sender_port = 0;  // what comes from there was forwarded by us
  };
  struct Waiting {
    std::int64_t due = 0;  // [us] steady
    int side = 0;          // where it goes
    std::vector<char> bytes;
  };
  void run();
  void take(int side);
  void send_due(std::int64_t now);
  [[nodiscard]] bool stays(const std::vector<char>& datagram) const;

  LossyLinkParams params_;
  std::set<std::string> local_;
  Side sides_[2];
  std::vector<Waiting> waiting_;
  std::mt19937_64 random_;
  std::atomic<std::int64_t> forwarded_ = 0;
  std::atomic<std::int64_t> lost_ = 0;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

}  // namespace luminav
