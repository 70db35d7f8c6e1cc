#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

enum class JobKind { kGo, kCarry, kTour, kHome, kGuide };
enum class JobState { kQueued, kDriving, kAtStop, kAsking, kDone, kFailed, kCancelled };
/// What it means when nobody confirms at a stop.
enum class TimeoutPolicy { kAsk, kGiveUp, kGoOn };

/// Where a job leads, and what ends the stay there.
struct JobStop {
  std::string place{};  ///< its name in the building's file; "" = the pose below
  Pose2 pose{};         ///< world
  bool has_theta = false;
  double pause = 0.0;     ///< [s] to stay there
  std::string text{};     ///< for people there
  bool photo = false;     ///< the camera's picture there is kept
  std::string confirm{};  ///< word that somebody must say before it goes on: "loaded", "unloaded"; "" = none
};

/// A picture that is to be kept: of which stop of which job.
struct PhotoWish {
  std::int64_t job = 0;
  std::size_t stop = 0;
  std::string place{};
};

/// What a person must decide.
struct Question {
  std::string text{};
  std::vector<std::string> answers{};
};

/// One job: a list of stops and how far it has come. All kinds are this; they differ in their stops alone.
struct Job {
  std::int64_t id = 0;  ///< of the request that brought it
  JobKind kind = JobKind::kGo;
  int priority = 0;
  TimeoutPolicy on_timeout = TimeoutPolicy::kAsk;
  std::string tour{};  ///< name of the stored tour; "" = none
  std::string sender{};
  std::vector<JobStop> stops{};
  JobState state = JobState::kQueued;
  std::size_t stop = 0;      ///< which of the stops
  std::int64_t goal_id = 0;  ///< of the GOAL that drives there; 0 = none sent yet
  int tries = 0;             ///< to find the charger's contacts
  std::string sentence{};    ///< what goes on, or how it ended
  std::optional<Question> question{};

  [[nodiscard]] bool is_over() const { return state >= JobState::kDone; }
};

/// What a person asks of the job service; see job_t.
struct JobRequest {
  enum class Action { kAdd, kConfirm, kCancel, kAnswer };
  std::int64_t id = 0;
  Action action = Action::kAdd;
  std::int64_t job = 0;
  JobKind kind = JobKind::kGo;
  int priority = 0;
  TimeoutPolicy on_timeout = TimeoutPolicy::kAsk;
  std::string tour{};
  std::vector<JobStop> stops{};
  std::string word{};
  std::string sender{};
};

/// "go", "carry", ...
const char* name_of(JobKind kind);
/// A stop as people call it.
std::string name_of(const JobStop& stop);

}  // namespace luminav
