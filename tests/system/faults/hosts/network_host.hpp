#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace luminav {

/// A network namespace of its own, alive as long as this object: stands for one machine of several. Throws
/// std::runtime_error where the kernel allows none.
class NetworkHost {
 public:
  NetworkHost();
  NetworkHost(const NetworkHost&) = delete;
  NetworkHost& operator=(const NetworkHost&) = delete;
  ~NetworkHost();

  /// Names the namespace for `ip link ... netns PID`.
  [[nodiscard]] pid_t holder() const { return holder_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Runs a shell command inside; throws when it fails.
  void run(const std::string& command) const;

 private:
  pid_t holder_ = -1;
  int descriptor_ = -1;
};

/// While it lives, what this thread opens and starts belongs to the host. Null: stays where it is.
class InsideHost {
 public:
  explicit InsideHost(const NetworkHost* host);
  InsideHost(const InsideHost&) = delete;
  InsideHost& operator=(const InsideHost&) = delete;
  ~InsideHost();

 private:
  int previous_ = -1;
};

/// Joins two hosts (10.77.0.1 and 10.77.0.2) by a wire that can be cut and joined again. Each sends its multicast
/// there; cut, both see their network card without a carrier, as when somebody pulls the plug.
class Cable {
 public:
  Cable(const NetworkHost& one, const NetworkHost& other);
  void cut();
  void join();
  /// Bytes that one of the hosts has put on the wire so far.
  [[nodiscard]] static std::int64_t sent_by(const NetworkHost& host);

 private:
  NetworkHost middle_;
};

/// Whether this program runs in a network namespace that is not the machine's.
bool has_own_network();

/// A second host, on a wire to this program's own network, which becomes its network card: its multicast goes there, as
/// that of a robot with Wi-Fi does. Throws std::runtime_error where that is not possible.
class Neighbour {
 public:
  static constexpr const char* kOwnAddress = "10.77.0.1";
  Neighbour();
  [[nodiscard]] const NetworkHost& host() const { return host_; }

 private:
  NetworkHost host_;
};

}  // namespace luminav
