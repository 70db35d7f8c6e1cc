// A process on an interface that is taken away and made anew: it says that it hears nothing, and hears again once there
// is something to hear. Nothing else runs there that could join the group for it. Exit status 77 where the kernel
// allows no network namespaces.
#include <fmt/format.h>

#include <stdexcept>

#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "tests/system/faults/hosts/network_host.hpp"

namespace luminav {
namespace {

constexpr const char* kMake =
    "ip link add net0 type veth peer name net1 && ip link set net1 up && ip link set net0 up && "
    "ip addr add 10.77.1.1/24 dev net0 && "
    "ip route add 224.0.0.0/4 dev net0";
constexpr int kPatience = 250;  // ticks of a tenth of a second

/// Counts what a process hears of itself while its interface comes and goes.
class Trial {
 public:
  explicit Trial(const NetworkHost& host) : host_(host), inbox_(*lcm_) {
    inbox_.on(channels::kNodeStatus, &Trial::on_status, this);
    loop_.every(100'000, [this] { tick(); });
  }
  int run() {
    loop_.run();
    return heard_again_ ? 0 : 1;
  }

 private:
  enum class Phase { kBefore, kWithout, kAfter };

  void on_status(const node_status_t& status) {
    ++heard_;
    if (phase_ == Phase::kAfter && status.state == node_status_t::STATE_READY) {
      heard_again_ = true;
      loop_.stop();
    }
  }
  void tick() {
    constexpr int kAWhile = 50;  // ticks: longer than it takes to notice
    ++ticks_;
    if (phase_ == Phase::kBefore && heard_ >= 2) {
      host_.run("ip link del net0");
      begin(Phase::kWithout, "the interface is gone");
    } else if (phase_ == Phase::kWithout && ticks_ >= kAWhile) {
      host_.run(kMake);
      begin(Phase::kAfter, "and made anew");
    } else if (ticks_ > kPatience) {
      fmt::print("FAILED: heard nothing more\n");
      loop_.stop();
    }
  }
  void begin(Phase phase, const char* what) {
    fmt::print("{} after {} messages\n", what, heard_);
    phase_ = phase;
    ticks_ = 0;
  }

  const NetworkHost& host_;
  LcmNetwork network_ = "udpm://239.255.76.67:7667?ttl=0";
  std::unique_ptr<lcm::LCM> lcm_ = open_lcm(network_);
  EventLoop loop_{*lcm_, "mapper", "p3dx", network_};
  Subscriber inbox_;
  Phase phase_ = Phase::kBefore;
  int heard_ = 0;
  int ticks_ = 0;
  bool heard_again_ = false;
};

int run() {
  std::unique_ptr<NetworkHost> host;
  try {
    host = std::make_unique<NetworkHost>();
    host->run(kMake);
  } catch (const std::runtime_error& error) {
    fmt::print("skipped: {}\n", error.what());
    return 77;
  }
  const InsideHost inside(host.get());
  const int status = Trial(*host).run();
  fmt::print("{} hears itself again\n", status == 0 ? "  ok  " : "FAILED");
  return status;
}

}  // namespace
}  // namespace luminav

int main() {
  return luminav::run_guarded("interface", luminav::run);
}
