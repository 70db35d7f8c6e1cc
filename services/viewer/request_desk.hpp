#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/survey_command_t.hpp>
#include <luminav/survey_status_t.hpp>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/network/command_seal.hpp"

namespace luminav {

/// The network took nothing; the message says so.
class NotSent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sends people's requests and repeats them at 5 Hz until their owner has obeyed. Publishes at once from the thread
/// that asks, so that a STOP needs no other thread to be alive; thread-safe. A newer request replaces an older one of
/// its kind. Reads no clock: the time is handed in.
class RequestDesk {
 public:
  enum class Kind : std::size_t { kGoal, kStop, kMotors, kInitialPose, kMap, kSurvey };
  enum class Fate { kNone, kWaiting, kAnswered, kUnanswered };

  /// What became of the newest request of a kind.
  struct State {
    Kind kind = Kind::kGoal;
    Fate fate = Fate::kNone;
    std::int64_t id = 0;
    std::int64_t asked = 0;  // [us] when it was asked
    std::string objection;   // of the owner, who answered but did not do it; "" = none
    bool engages = false;    // of a STOP: it asks for one, not for the release
  };

  /// `sender` names this desk in STOP: two desks of one name would take each other's requests for their own.
  RequestDesk(lcm::LCM& lcm, std::string sender, std::optional<CommandKey> key = {})
      : commands_(lcm, key), sender_(std::move(sender)) {}

  /// From now on whatever speaks of places or poses is refused with this sentence; "" = no longer. Stops, cancellations
  /// and pauses are sent all the same.
  void object(std::string why);

  // Each stamps, numbers and sends the request and returns its id; throws RequestError where it is refused. `now` [us]
  // since the epoch. Throws NotSent when the network takes nothing; then only the engaging of a STOP is tried again by
  // repeat().
  std::int64_t send(goal_t goal, std::int64_t now);
  std::int64_t send(stop_t stop, std::int64_t now);
  std::int64_t send(motors_command_t command, std::int64_t now);
  std::int64_t send(initial_pose_t guess, std::int64_t now);
  std::int64_t send(map_command_t command, std::int64_t now);
  std::int64_t send(survey_command_t command, std::int64_t now);

  /// Requests for jobs are many at once: none takes the place of another. What became of them is in JOB_STATUS.
  std::int64_t send(job_t job, std::int64_t now);

  /// Somebody has this viewer's page in view: says so in SUPERVISION, at most five times a second. Throws NotSent.
  void attend(std::int64_t now);

  /// A fifth of a second has passed: repeats what was not obeyed yet. Gives up after 10 s, but never on a STOP.
  void repeat(std::int64_t now);

  void on_navigation_status(const navigation_status_t& message);
  void on_control_status(const control_status_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_pose(const pose_t& message);
  void on_grid_tile(const grid_tile_t& message);
  void on_job_status(const job_status_t& message);
  void on_survey_status(const survey_status_t& message);

  [[nodiscard]] std::vector<State> states() const;
  static std::string_view name_of(Kind kind);
  static std::string_view name_of(Fate fate);

 private:
  static constexpr std::int64_t kPatience = 10'000'000;  // [us]

  struct Pending {
    State state;
    std::function<bool(std::int64_t now)> publish;  // false: not sent
    bool gives_up = true;
  };
  /// What an owner of STOP last said of it, and whether it has obeyed the newest request.
  struct StopEcho {
    std::int64_t id = 0;
    bool engaged = false;
    bool heard = false;
    bool obeyed = false;
    std::int64_t id_when_asked = 0;
  };
  template <typename Message>
  std::int64_t post(Kind kind, const char* channel, Message message, std::int64_t now, bool gives_up = true);
  /// Ids grow from request to request, across viewers and other tools: the wall clock, and above every id that was
  /// heard.
  std::int64_t new_id(std::int64_t now);
  void hear(Kind kind, std::int64_t id, const std::string& objection = "");
  /// A release is given up when somebody has asked for another stop since.
  void hear_of_stop(StopEcho& owner, std::int64_t id, bool engaged);

  CommandPublisher commands_;
  std::string sender_;
  mutable std::mutex mutex_;
  std::array<Pending, 6> pending_;
  std::vector<job_t> pending_jobs_;  // not echoed yet; their stamps say when they were asked
  void check_objection() const;

  std::string objection_;
  std::int64_t last_id_ = 0;
  std::int64_t attended_ = 0;  // [us] when SUPERVISION was sent last
  StopEcho driver_;
  StopEcho controller_;
};

}  // namespace luminav
