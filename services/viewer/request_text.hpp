#pragma once

#include <luminav/goal_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>
#include <stdexcept>
#include <string>

#include "services/common/building/building.hpp"

namespace luminav {

/// A request that is not what it should be; the message says what is allowed.
class RequestError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Each reads the JSON body of a request strictly: unknown keys, wrong types, numbers that are not finite or farther
// than 10 km are a RequestError. Stamps and ids are left to the sender.

/// {"action": "go" | "cancel" | "pause" | "resume", "poses": [{"x", "y", "theta"?, "wait"?} | {"place"}], "loop"?}.
goal_t read_goal_request(const std::string& body, const Building& building);
/// {"engaged": true | false}. Anything unreadable engages: a stop that is misspelt still stops.
stop_t read_stop_request(const std::string& body);
/// {"enable": true | false}.
motors_command_t read_motors_request(const std::string& body);
/// {"x", "y", "theta", "sigma"?, "sigma_theta"?}: a guess with its deviations [m, rad].
initial_pose_t read_initial_pose_request(const std::string& body);

}  // namespace luminav
