#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>

#include "drivers/simulator/arcos/battery.hpp"
#include "drivers/simulator/base_board.hpp"
#include "drivers/simulator/world/world.hpp"
#include "drivers/simulator/world/world_truth.hpp"

namespace luminav {

/// Lets a simulated world and the simulated base's controller in it go on, and publishes the truth at 100 Hz. Bytes to
/// and from the controller are moved by the caller.
class SimulatorNode {
 public:
  static constexpr std::int64_t kTick = 10'000;  // [us]

  SimulatorNode(lcm::LCM& lcm, std::uint64_t seed, const WorldTruth& truth, BaseBoard& board);

  /// Ticks of exactly 10 ms up to a time [us]; the first call only sets where time begins.
  void advance_to(std::int64_t utime);
  /// The serial line is out of its socket; the caller moves no bytes then.
  [[nodiscard]] bool serial_unplugged() const { return world_.state().serial_unplugged; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const Battery& battery() const { return battery_; }
  /// [us] of the last tick.
  [[nodiscard]] std::int64_t utime() const { return now_; }

 private:
  void tick();
  void publish_truth();

  lcm::LCM& lcm_;
  BaseBoard& board_;
  World world_;
  WheelReport wheels_;
  Battery battery_;
  std::int64_t session_ = 0;  // [us] when time began; 0 = not yet
  std::int64_t now_ = 0;      // [us]
  std::int32_t sequence_ = 0;
};

}  // namespace luminav
