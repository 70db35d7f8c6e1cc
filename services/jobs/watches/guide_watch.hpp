#pragma once

#include <optional>
#include <string>

#include "services/common/geometry/pose2.hpp"
#include "services/jobs/watches/follower_watch.hpp"

namespace luminav {

struct GuideParams {
  FollowerParams follower{};
  double wait = 10.0;   // [s] for a visitor who fell back, before it goes back for him, and beside him after that
  int max_returns = 2;  // that it goes back for him, then it gives up
};

/// What a guide sees and does at one moment.
struct GuideMoment {
  double seconds = 0.0;                     // since the last one
  double driven = 0.0;                      // [m] forward since then
  std::optional<double> behind{};           // [m] nearest echo straight behind it
  std::optional<Pose2> world_from_robot{};  // while it is known
  bool has_arrived = false;                 // where it was sent last
};

/// Leads a visitor: looks whether he follows, waits for him, goes back to where it saw him last, and gives up politely.
class GuideWatch {
 public:
  enum class Advice { kNone, kWait, kLeadOn, kGoBack, kGiveUp };

  explicit GuideWatch(const GuideParams& params) : params_(params), follower_(params.follower) {}

  void begin();
  /// The visitor's own word: "here" or "wait".
  void hear(const std::string& word);
  Advice update(const GuideMoment& moment);

  /// Where the robot was when he was behind it.
  [[nodiscard]] const std::optional<Pose2>& last_seen() const { return last_seen_; }
  /// What it does apart from driving, in words; "" = it leads.
  [[nodiscard]] std::string sentence() const;
  /// It drives to the place, not back to its visitor.
  [[nodiscard]] bool leads() const { return phase_ == Phase::kLeading; }

 private:
  enum class Phase { kLeading, kWaiting, kReturning, kBeside };

  Advice lead(const GuideMoment& moment);
  Advice wait(const GuideMoment& moment);
  void enter(Phase phase);

  GuideParams params_;
  FollowerWatch follower_;
  Phase phase_ = Phase::kLeading;
  std::optional<Pose2> last_seen_;
  double waited_ = 0.0;  // [s]
  int returns_ = 0;
  bool shall_wait_ = false;
};

}  // namespace luminav
