#include "services/viewer/request_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "services/common/geometry/angle.hpp"
#include "services/viewer/http/request_fields.hpp"

namespace luminav {
namespace {

using Json = nlohmann::json;

constexpr double kFarthest = 10'000.0;   // [m]
constexpr double kLongestWait = 3600.0;  // [s]
constexpr std::size_t kMaxPoses = 100;
constexpr std::int64_t kLatest = 1LL << 53;  // JavaScript's largest whole number

goal_pose_t place_called(const std::string& name, const Building& building) {
  for (const Place& place : building.places) {
    if (place.name == name) {
      goal_pose_t pose{};
      pose.place = place.name;
      pose.x = place.pose.x;
      pose.y = place.pose.y;
      pose.has_theta = place.has_theta;
      pose.theta = place.pose.theta;
      return pose;
    }
  }
  throw RequestError("place: the building has none of that name");
}

/// A place by its name, or a point.
goal_pose_t read_pose(const Json& item, const Building& building) {
  if (item.contains("place")) {
    return place_called(text(item, "place"), building);
  }
  goal_pose_t pose{};
  pose.x = number(item, "x", -kFarthest, kFarthest);
  pose.y = number(item, "y", -kFarthest, kFarthest);
  pose.has_theta = item.contains("theta");
  pose.theta = pose.has_theta ? wrap_angle(number(item, "theta", -100.0, 100.0)) : 0.0;
  return pose;
}

goal_pose_t read_goal_pose(const Json& item, const Building& building) {
  check_item(item, "poses", {"x", "y", "theta", "wait", "place"});
  goal_pose_t pose = read_pose(item, building);
  pose.wait = item.contains("wait") ? number(item, "wait", 0.0, kLongestWait) : 0.0;
  return pose;
}

job_stop_t read_job_stop(const Json& item, const Building& building) {
  check_item(item, "stops", {"x", "y", "theta", "place", "pause", "text"});
  const goal_pose_t pose = read_pose(item, building);
  job_stop_t stop{};
  stop.place = pose.place;
  stop.x = pose.x;
  stop.y = pose.y;
  stop.has_theta = pose.has_theta;
  stop.theta = pose.theta;
  stop.pause = item.contains("pause") ? number(item, "pause", 0.0, kLongestWait) : 0.0;
  stop.text = item.contains("text") ? text(item, "text") : "";
  return stop;
}

std::int8_t read_action(const std::string& word) {
  if (word == "go") return goal_t::ACTION_GO;
  if (word == "cancel") return goal_t::ACTION_CANCEL;
  if (word == "pause") return goal_t::ACTION_PAUSE;
  if (word == "resume") return goal_t::ACTION_RESUME;
  throw RequestError("action: must be go, cancel, pause or resume");
}

std::int8_t read_policy(const std::string& word) {
  if (word == "stop") return goal_t::POLICY_STOP;
  if (word == "skip") return goal_t::POLICY_SKIP;
  if (word == "retry") return goal_t::POLICY_RETRY;
  throw RequestError("policy: must be stop, skip or retry");
}

}  // namespace

goal_t read_goal_request(const std::string& body, const Building& building) {
  const Json object = read_object(body, {"action", "poses", "loop", "policy"});
  goal_t goal{};
  goal.action = read_action(text(object, "action"));
  goal.policy = object.contains("policy") ? read_policy(text(object, "policy")) : goal_t::POLICY_STOP;
  if (goal.action != goal_t::ACTION_GO) {
    return goal;
  }
  const auto poses = object.find("poses");
  if (poses == object.end() || !poses->is_array() || poses->empty() || poses->size() > kMaxPoses) {
    throw RequestError(fmt::format("poses: must be a list of 1 to {}", kMaxPoses));
  }
  for (const Json& item : *poses) {
    goal.poses.push_back(read_goal_pose(item, building));
  }
  goal.count = static_cast<std::int32_t>(goal.poses.size());
  goal.loop = object.contains("loop") && boolean(object, "loop");
  return goal;
}

stop_t read_stop_request(const std::string& body) {
  const Json object = Json::parse(body, nullptr, false);
  stop_t stop{};
  stop.engaged = !(object.is_object() && object.contains("engaged") && object["engaged"] == false);
  return stop;
}

motors_command_t read_motors_request(const std::string& body) {
  const Json object = read_object(body, {"enable"});
  motors_command_t command{};
  command.enable = boolean(object, "enable");
  return command;
}

initial_pose_t read_initial_pose_request(const std::string& body) {
  const Json object = read_object(body, {"x", "y", "theta", "sigma", "sigma_theta"});
  initial_pose_t guess{};
  guess.x = number(object, "x", -kFarthest, kFarthest);
  guess.y = number(object, "y", -kFarthest, kFarthest);
  guess.theta = wrap_angle(number(object, "theta", -100.0, 100.0));
  // a tap on a map is good for half a metre, a drag for 20 degrees
  const double sigma = object.contains("sigma") ? number(object, "sigma", 0.01, 10.0) : 0.5;
  const double sigma_theta = object.contains("sigma_theta") ? number(object, "sigma_theta", 0.01, kPi) : radians(20.0);
  guess.covariance[0] = guess.covariance[4] = sigma * sigma;
  guess.covariance[8] = sigma_theta * sigma_theta;
  return guess;
}

map_command_t read_map_request(const std::string& body) {
  const std::string action = text(read_object(body, {"action"}), "action");
  map_command_t command{};
  if (action == "save") {
    command.action = map_command_t::ACTION_SAVE;
  } else if (action == "clear_evidence") {
    command.action = map_command_t::ACTION_CLEAR_EVIDENCE;
  } else {
    throw RequestError("action: must be save or clear_evidence");
  }
  return command;
}

survey_command_t read_survey_request(const std::string& body) {
  const Json object = read_object(body, {"action", "name"});
  survey_command_t command{};
  command.action = choice(object, "action", {"finish", "place", "explore", "stay"});
  if (command.action == survey_command_t::ACTION_PLACE) {
    command.name = text(object, "name");
  }
  return command;
}

job_t read_job_request(const std::string& body, const Building& building) {
  const Json object = read_object(body, {"action", "kind", "stops", "tour", "priority", "on_timeout", "job", "word"});
  job_t job{};
  job.action = choice(object, "action", {"add", "confirm", "cancel", "answer"});
  if (job.action != job_t::ACTION_ADD) {
    job.job = integer(object, "job", 1, kLatest);
    job.word = object.contains("word") ? text(object, "word") : "";
    return job;
  }
  job.kind = choice(object, "kind", {"go", "carry", "tour", "home", "guide"});
  job.tour = object.contains("tour") ? text(object, "tour") : "";
  job.priority = object.contains("priority") ? static_cast<std::int32_t>(integer(object, "priority", 0, 100)) : 0;
  if (object.contains("on_timeout")) {
    job.on_timeout = choice(object, "on_timeout", {"ask", "give_up", "go_on"});
  }
  if (const auto stops = object.find("stops"); stops != object.end()) {
    if (!stops->is_array() || stops->size() > kMaxPoses) {
      throw RequestError(fmt::format("stops: must be a list of at most {}", kMaxPoses));
    }
    for (const Json& item : *stops) {
      job.stops.push_back(read_job_stop(item, building));
    }
  }
  job.count = static_cast<std::int32_t>(job.stops.size());
  return job;
}

Steering read_steering(const std::string& body) {
  const Json object = read_object(body, {"session", "sequence", "linear", "angular", "seen"});
  Steering steering;
  steering.session = integer(object, "session", 1, kLatest);
  steering.sequence = static_cast<std::int32_t>(integer(object, "sequence", 0, 2'000'000'000));
  steering.linear = number(object, "linear", -10.0, 10.0);
  steering.angular = number(object, "angular", -10.0, 10.0);
  steering.seen = integer(object, "seen", 0, kLatest);
  return steering;
}

ProcessOrder read_process_order(const std::string& body) {
  const Json object = read_object(body, {"name", "action"});
  ProcessOrder order;
  order.name = text(object, "name");
  const std::string word = text(object, "action");
  for (const auto action :
       {ProcessOrder::Action::kStart, ProcessOrder::Action::kStop, ProcessOrder::Action::kRestart}) {
    if (word == name_of(action)) {
      order.action = action;
      return order;
    }
  }
  throw RequestError("action: must be start, stop or restart");
}

std::optional<FileOrder::Kind> read_file_kind(std::string_view word) {
  return word == "recording" ? std::optional(FileOrder::Kind::kRecording)
         : word == "map"     ? std::optional(FileOrder::Kind::kMap)
         : word == "photo"   ? std::optional(FileOrder::Kind::kPhoto)
                             : std::nullopt;
}

FileOrder read_file_order(const std::string& body) {
  const Json object = read_object(body, {"action", "kind", "name"});
  if (text(object, "action") != "delete") {
    throw RequestError("action: must be delete");
  }
  const std::optional<FileOrder::Kind> kind = read_file_kind(text(object, "kind"));
  if (!kind) {
    throw RequestError("kind: must be recording, map or photo");
  }
  return {*kind, text(object, "name")};
}

PlaybackOrder read_playback_order(const std::string& body) {
  const Json object = read_object(body, {"playing", "speed", "position"});
  if (object.empty()) {
    throw RequestError("give playing, speed or position");
  }
  PlaybackOrder order;
  if (object.contains("playing")) {
    order.playing = boolean(object, "playing");
  }
  if (object.contains("speed")) {
    order.speed = number(object, "speed", 0.5, 16.0);
  }
  if (object.contains("position")) {
    order.position = number(object, "position", 0.0, 1e9);
  }
  return order;
}

std::string_view name_of(ProcessOrder::Action action) {
  switch (action) {
    case ProcessOrder::Action::kStart:
      return "start";
    case ProcessOrder::Action::kStop:
      return "stop";
    case ProcessOrder::Action::kRestart:
      return "restart";
  }
  return "";
}

}  // namespace luminav
