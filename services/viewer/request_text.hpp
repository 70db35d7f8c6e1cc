#pragma once

#include <luminav/goal_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/survey_command_t.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "services/common/building/building.hpp"

namespace luminav {

/// A request that is not what it should be; the message says what is allowed.
class RequestError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How a person holds the stick at one moment.
struct Steering {
  std::int64_t session = 0;   // of the page
  std::int32_t sequence = 0;  // counts up within the session
  double linear = 0.0;        // [m/s] forward
  double angular = 0.0;       // [rad/s] counter-clockwise
  std::int64_t seen = 0;      // [us] this host's clock when it was sent, as the page knows it from the events
};

/// What a person wants of a process.
struct ProcessOrder {
  enum class Action { kStart, kStop, kRestart };
  std::string name;
  Action action = Action::kRestart;
};
std::string_view name_of(ProcessOrder::Action action);

/// A recording, a saved map or a photo that is to be deleted.
struct FileOrder {
  enum class Kind { kRecording, kMap, kPhoto };
  Kind kind = Kind::kRecording;
  std::string name;
};

/// What a person wants of a log that is shown; what is not given stays.
struct PlaybackOrder {
  std::optional<bool> playing = {};
  std::optional<double> speed = {};     // times real time
  std::optional<double> position = {};  // [s] since the log's beginning, to jump to
};

// Each reads the JSON body of a request strictly: unknown keys, wrong types, numbers that are not finite or farther
// than 10 km are a RequestError. Stamps, ids and the sender's name are left to the desk.

/// {"action": "go" | "cancel" | "pause" | "resume", "poses": [{"x", "y", "theta"?, "wait"?} | {"place"}], "loop"?,
/// "policy"?: "stop" | "skip" | "retry" when a pose cannot be reached}.
goal_t read_goal_request(const std::string& body, const Building& building);
/// {"engaged": true | false}. Anything unreadable engages: a stop that is misspelt still stops.
stop_t read_stop_request(const std::string& body);
/// {"enable": true | false}.
motors_command_t read_motors_request(const std::string& body);
/// {"x", "y", "theta", "sigma"?, "sigma_theta"?}: a guess with its deviations [m, rad].
initial_pose_t read_initial_pose_request(const std::string& body);
/// {"action": "save" | "clear_evidence"}: into the mapper's own file; a page cannot name another.
map_command_t read_map_request(const std::string& body);
/// {"action": "add", "kind": "go" | "carry" | "tour" | "home" | "guide", "stops"?: [{"x", "y", "theta"?} or {"place"},
/// with "pause"? [s] and "text"?], "tour"?, "priority"?, "on_timeout"?: "ask" | "give_up" | "go_on"}, or {"action":
/// "confirm" | "cancel" | "answer", "job", "word"?}. The job service says whether such a job can be done.
job_t read_job_request(const std::string& body, const Building& building);
/// {"action": "finish" | "explore" | "stay"} or {"action": "place", "name"}: the surveyor says whether such a name can
/// be given.
survey_command_t read_survey_request(const std::string& body);
/// {"session", "sequence", "linear", "angular", "seen"}.
Steering read_steering(const std::string& body);
/// {"name", "action": "start" | "stop" | "restart"}.
ProcessOrder read_process_order(const std::string& body);
/// {"playing"?: true | false, "speed"?: 0.5 to 16, "position"?: [s]}, at least one of them.
PlaybackOrder read_playback_order(const std::string& body);
/// {"action": "delete", "kind": "recording" | "map", "name"}.
/// "recording", "map" or "photo"; nothing for anything else.
std::optional<FileOrder::Kind> read_file_kind(std::string_view word);
FileOrder read_file_order(const std::string& body);

}  // namespace luminav
