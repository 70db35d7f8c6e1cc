#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/stop_t.hpp>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/network/command_seal.hpp"

namespace luminav {

/// Sends people's requests and repeats them at 5 Hz until their owner echoes the id. Publishes at once from the thread
/// that asks, so that a STOP needs no other thread to be alive; thread-safe. A newer request replaces an older one of
/// its kind. Reads no clock: the time is handed in.
class RequestDesk {
 public:
  enum class Kind : std::size_t { kGoal, kStop, kMotors, kInitialPose, kMap };
  enum class Fate { kNone, kWaiting, kAnswered, kUnanswered };

  /// What became of the newest request of a kind.
  struct State {
    Kind kind = Kind::kGoal;
    Fate fate = Fate::kNone;
    std::int64_t id = 0;
    std::int64_t asked = 0;  // [us] when it was asked
    std::string objection;   // of the owner, who answered but did not do it; "" = none
  };

  explicit RequestDesk(lcm::LCM& lcm, std::optional<CommandKey> key = {}) : commands_(lcm, key) {}

  /// From now on whatever speaks of places or poses is refused with this sentence; "" = no longer. Stops, cancellations
  /// and pauses are sent all the same.
  void object(std::string why);

  // Each stamps, numbers and sends the request and returns its id; throws RequestError where it is refused. `now` [us]
  // since the epoch.
  std::int64_t send(goal_t goal, std::int64_t now);
  std::int64_t send(stop_t stop, std::int64_t now);
  std::int64_t send(motors_command_t command, std::int64_t now);
  std::int64_t send(initial_pose_t guess, std::int64_t now);
  std::int64_t send(map_command_t command, std::int64_t now);

  /// A fifth of a second has passed: repeats what nobody has echoed. Gives up after 10 s, but never on a STOP.
  void repeat(std::int64_t now);

  void on_navigation_status(const navigation_status_t& message);
  void on_control_status(const control_status_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_pose(const pose_t& message);
  void on_grid_tile(const grid_tile_t& message);

  [[nodiscard]] std::vector<State> states() const;
  static std::string_view name_of(Kind kind);
  static std::string_view name_of(Fate fate);

 private:
  static constexpr std::int64_t kPatience = 10'000'000;  // [us]

  struct Pending {
    State state;
    std::function<void(std::int64_t now)> publish;
    bool gives_up = true;
  };
  template <typename Message>
  std::int64_t post(Kind kind, const char* channel, Message message, std::int64_t now, bool gives_up = true);
  /// Ids grow from request to request, across viewers and other tools: the wall clock, and above every id that was
  /// heard.
  std::int64_t new_id(std::int64_t now);
  void hear(Kind kind, std::int64_t id, const std::string& objection = "");
  void heard_by_both();

  CommandPublisher commands_;
  mutable std::mutex mutex_;
  std::array<Pending, 5> pending_;
  void check_objection() const;

  std::string objection_;
  std::int64_t last_id_ = 0;
  std::int64_t stop_heard_by_driver_ = 0;
  std::int64_t stop_heard_by_controller_ = 0;
};

}  // namespace luminav
