#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/jobs/watches/follower_watch.hpp"

namespace luminav {

struct GuideParams {
  FollowerParams follower{};
  double speed = 0.4;   // [m/s] at which it leads at most; slower the longer nobody was heard behind it
  double wait = 10.0;   // [s] for a visitor who fell back, before it goes back for him, and beside him after that
  int max_returns = 2;  // that it goes back for him to one place, then it gives up
};

/// What a guide hears and does at one moment.
struct GuideMoment {
  double seconds = 0.0;                     // since the last one
  double driven = 0.0;                      // [m] forward since then
  std::vector<Echo> echoes{};               // since then
  std::optional<Pose2> world_from_robot{};  // while it is known
  bool has_arrived = false;                 // where it was sent last, or as near as it gets
};

/// Leads a visitor: looks whether he follows, on the way and at its end, waits for him, goes back to where it heard him
/// last, and gives up politely.
class GuideWatch {
 public:
  enum class Advice { kNone, kWait, kLeadOn, kGoBack, kGiveUp };

  GuideWatch(const GuideParams& params, const std::shared_ptr<const PriorMap>& walls)
      : params_(params), follower_(params.follower, walls), may_be_alone_(params.follower.lost_after + kPassed) {}

  /// A visitor stands near it.
  void begin();
  /// The visitor's own word: "here" or "wait".
  void hear(const std::string& word);
  Advice update(const GuideMoment& moment);

  /// Where the robot was when he was near it.
  [[nodiscard]] const std::optional<Pose2>& last_seen() const { return last_seen_; }
  /// What it does apart from driving, in words; "" = it leads.
  [[nodiscard]] std::string sentence() const;
  /// It drives to the place, not back to its visitor.
  [[nodiscard]] bool leads() const { return phase_ == Phase::kLeading; }
  /// How fast it may drive now [m/s]: a visitor who falls back can catch up.
  [[nodiscard]] double max_speed() const;
  /// It stands and waits for its visitor.
  [[nodiscard]] bool stands() const { return phase_ == Phase::kWaiting || phase_ == Phase::kBeside; }

 private:
  enum class Phase { kLeading, kWaiting, kReturning, kBeside };

  static constexpr double kPassed = 1.0;  // [m] until who stands before it walks behind it

  [[nodiscard]] bool is_with_it() const;
  Advice lead(const GuideMoment& moment);
  Advice wait();
  Advice return_to_him(const GuideMoment& moment);
  Advice stand_beside();
  void enter(Phase phase);

  GuideParams params_;
  FollowerWatch follower_;
  Phase phase_ = Phase::kLeading;
  std::optional<Pose2> last_seen_;
  std::optional<Pose2> returned_to_;
  double may_be_alone_;  // [m] of driving, before he is lost
  double waited_ = 0.0;  // [s]
  int returns_ = 0;      // to that place
  bool shall_wait_ = false;
};

}  // namespace luminav
