#include "services/jobs/watches/guide_watch.hpp"

namespace luminav {

void GuideWatch::begin() {
  *this = GuideWatch(params_);
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
  switch (phase_) {
    case Phase::kLeading:
      return lead(moment);
    case Phase::kWaiting:
      return wait(moment);
    case Phase::kReturning:
      if (moment.has_arrived) {
        enter(Phase::kBeside);
      }
      return Advice::kNone;
    case Phase::kBeside:
      // he may stand before it, where no sonar tells him from a wall: it leads on, and sees whether he comes
      if (waited_ < params_.wait) {
        return Advice::kNone;
      }
      follower_.begin();
      enter(Phase::kLeading);
      return Advice::kLeadOn;
  }
  return Advice::kNone;
}

GuideWatch::Advice GuideWatch::lead(const GuideMoment& moment) {
  follower_.update(moment.behind, moment.driven, moment.world_from_robot);
  if (follower_.is_near() && moment.world_from_robot) {
    last_seen_ = moment.world_from_robot;
  }
  if (!shall_wait_ && (!follower_.is_lost() || moment.has_arrived)) {
    return Advice::kNone;
  }
  enter(Phase::kWaiting);
  return Advice::kWait;
}

GuideWatch::Advice GuideWatch::wait(const GuideMoment& moment) {
  follower_.update(moment.behind, moment.driven, moment.world_from_robot);
  if (shall_wait_) {
    waited_ = 0.0;  // until he says that he is there
    return Advice::kNone;
  }
  if (follower_.is_near()) {
    enter(Phase::kLeading);
    return Advice::kLeadOn;
  }
  if (waited_ < params_.wait) {
    return Advice::kNone;
  }
  if (!last_seen_ || returns_ >= params_.max_returns) {
    return Advice::kGiveUp;
  }
  ++returns_;
  enter(Phase::kReturning);
  return Advice::kGoBack;
}

}  // namespace luminav
