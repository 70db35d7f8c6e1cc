#include "services/jobs/watches/guide_watch.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr double kMoment = 0.3;     // [m] driven: he was near a moment ago
constexpr double kAtPlace = 0.5;    // [m] driven: who was near then has arrived, too
constexpr double kSlowest = 0.4;    // share of its speed that is left when it is about to wait
constexpr double kElsewhere = 2.0;  // [m] from the place that it went back to: he has followed since

}  // namespace

void GuideWatch::begin() {
  follower_.begin();
  phase_ = Phase::kLeading;
  last_seen_.reset();
  returned_to_.reset();
  may_be_alone_ = params_.follower.lost_after + kPassed;
  waited_ = 0.0;
  returns_ = 0;
  shall_wait_ = false;
}

void GuideWatch::hear(const std::string& word) {
  shall_wait_ = word == "wait";
  if (!shall_wait_) {
    follower_.see();
  }
}

void GuideWatch::enter(Phase phase) {
  phase_ = phase;
  waited_ = 0.0;
}

std::string GuideWatch::sentence() const {
  switch (phase_) {
    case Phase::kLeading:
      return "";
    case Phase::kWaiting:
      return "waits for its visitor";
    case Phase::kReturning:
      return "goes back for its visitor";
    case Phase::kBeside:
      return "waits where it saw its visitor last";
  }
  return "";
}

GuideWatch::Advice GuideWatch::update(const GuideMoment& moment) {
  waited_ += moment.seconds;
  if (follower_.update(moment.echoes, moment.seconds, moment.driven, moment.world_from_robot)) {
    may_be_alone_ = params_.follower.lost_after;
  }
  switch (phase_) {
    case Phase::kLeading:
      return lead(moment);
    case Phase::kWaiting:
      return wait();
    case Phase::kReturning:
      return return_to_him(moment);
    case Phase::kBeside:
      return stand_beside();
  }
  return Advice::kNone;
}

double GuideWatch::max_speed() const {
  const double alone = std::clamp((follower_.alone() - kMoment) / (may_be_alone_ - kMoment), 0.0, 1.0);
  return params_.speed * (1.0 - alone * (1.0 - kSlowest));
}

bool GuideWatch::is_with_it() const {
  return follower_.alone() < kMoment;
}

GuideWatch::Advice GuideWatch::lead(const GuideMoment& moment) {
  if (moment.world_from_robot && (is_with_it() || !last_seen_)) {
    last_seen_ = moment.world_from_robot;
  }
  if (!shall_wait_ && follower_.alone() <= (moment.has_arrived ? kAtPlace : may_be_alone_)) {
    return Advice::kNone;
  }
  enter(Phase::kWaiting);
  return Advice::kWait;
}

GuideWatch::Advice GuideWatch::wait() {
  if (shall_wait_) {
    waited_ = 0.0;  // until he says that he is there
    return Advice::kNone;
  }
  if (is_with_it()) {
    enter(Phase::kLeading);
    return Advice::kLeadOn;
  }
  if (waited_ < params_.wait || !last_seen_) {
    return Advice::kNone;
  }
  if (returned_to_ && distance(*returned_to_, *last_seen_) > kElsewhere) {
    returns_ = 0;
  }
  if (returns_ >= params_.max_returns) {
    return Advice::kGiveUp;
  }
  ++returns_;
  returned_to_ = last_seen_;
  enter(Phase::kReturning);
  return Advice::kGoBack;
}

GuideWatch::Advice GuideWatch::return_to_him(const GuideMoment& moment) {
  if (is_with_it()) {
    enter(Phase::kBeside);
    return Advice::kWait;
  }
  if (moment.has_arrived) {
    enter(Phase::kBeside);
  }
  return Advice::kNone;
}

GuideWatch::Advice GuideWatch::stand_beside() {
  if (waited_ < params_.wait) {
    return Advice::kNone;
  }
  // he may have stepped off the trail: it leads on, and hears whether he comes
  may_be_alone_ = follower_.alone() + params_.follower.lost_after + kPassed;
  enter(Phase::kLeading);
  return Advice::kLeadOn;
}

}  // namespace luminav
