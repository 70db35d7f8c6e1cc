#include "services/surveyor/explore/exploration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kSameTarget = 0.01;  // [m]
constexpr double kProgress = 0.3;     // [m] that a robot moves which is on its way

}  // namespace

void Exploration::begin(TriedFloor tried) {
  *this = Exploration(params_);
  tried_ = std::move(tried);
  phase_ = Phase::kLooking;
  sentence_ = "exploring";
}

void Exploration::end(std::int64_t now, const std::string& why) {
  if (!is_active()) {
    return;
  }
  phase_ = Phase::kIdle;
  sentence_ = why;
  if (goal_id_ != 0) {
    goal_id_ = std::max(now, goal_id_ + 1);
    request_ = ExploreGoal{.id = goal_id_, .is_cancel = true};
  }
}

void Exploration::hear(const GoalNews& news) {
  news_ = news;
  if (request_ && news.goal_id >= request_->id) {
    request_.reset();
  }
  if (is_active() && goal_id_ != 0 && news.goal_id > goal_id_ && is_mine(news)) {
    goal_id_ = news.goal_id;  // a pause has an id of its own, and so has what ends it
  } else if (is_active() && goal_id_ != 0 && news.goal_id > goal_id_) {
    phase_ = Phase::kIdle;
    sentence_ = "exploring ended: somebody else told the robot what to do; the survey goes on";
  }
}

bool Exploration::is_mine(const GoalNews& news) const {
  return news.target && (*news.target - sent_).norm() < kSameTarget;
}

bool Exploration::is_due(std::int64_t now) const {
  return is_active() && (now < searched_ || now - searched_ >= microseconds_of(params_.search_period));
}

void Exploration::update(std::int64_t now, const Surroundings& around) {
  searched_ = now;
  if (news_ && news_->is_paused) {
    progress_ = now;
    return;
  }
  const bool has_moved = around.drawing != drawing_;
  drawing_ = around.drawing;
  const bool is_over = judge_goal(now, around.world_from_robot.position());
  if (phase_ == Phase::kHome) {
    drive_home(now, is_over, has_moved);
    return;
  }
  const FrontierSearch found(params_.search, around.grid, params_.leniencies[leniency_], around.looks, tried_,
                             around.world_from_robot.position());
  floor_ = found.open_floor();
  if (phase_ == Phase::kDriving) {
    const bool is_spent = found.open_share(hoped_) < params_.spent_share;
    if (!is_spent && !is_over && !has_moved) {
      return;
    }
    if (is_spent || is_over) {
      tried_.add(hoped_);
      has_tried_ = true;
      phase_ = Phase::kLooking;
      searched_ = 0;                         // the next one at once
      leniency_ = is_spent ? 0 : leniency_;  // a door it was
      return;
    }
  }
  choose(now, found);
}

void Exploration::choose(std::int64_t now, const FrontierSearch& found) {
  if (floor_.best) {
    hoped_ = found.best_cells();
    empty_ = 0;
    phase_ = Phase::kDriving;
    go(now, floor_.best->position);
    sentence_ = fmt::format("exploring: {} open ends, {:.0f} of {:.0f} m2 of ceiling seen; driving to ({:.1f}, {:.1f})",
                            floor_.frontiers, floor_.reachable - floor_.unseen, floor_.reachable, sent_.x(), sent_.y());
    return;
  }
  phase_ = phase_ == Phase::kLastLook ? phase_ : Phase::kLooking;
  if (++empty_ < params_.looks) {
    return;
  }
  empty_ = 0;
  if (leniency_ + 1 < params_.leniencies.size()) {
    ++leniency_;
  } else if (phase_ == Phase::kLastLook) {
    phase_ = Phase::kFinished;
    sentence_ = "explored, and back where it began";
  } else {
    phase_ = Phase::kHome;
    go(now, Eigen::Vector2d::Zero());
    sentence_ =
        fmt::format("exploring: nothing is left that can be reached, {:.0f} m2; driving home", floor_.reachable);
  }
}

void Exploration::drive_home(std::int64_t now, bool is_over, bool has_moved) {
  if (is_over && news_->has_arrived) {
    phase_ = Phase::kLastLook;
    leniency_ = 0;
    sentence_ = "exploring: back where it began, looking once more";
  } else if (is_over && ++home_tries_ >= params_.home_tries) {
    end(now, fmt::format("explored; the robot did not come back to where it began: {}",
                         news_->cause.empty() ? "it stood still on the way" : news_->cause));
    phase_ = Phase::kFinished;
  } else if (is_over || has_moved) {
    go(now, Eigen::Vector2d::Zero());
  }
}

void Exploration::go(std::int64_t now, const Eigen::Vector2d& position) {
  goal_id_ = std::max(now, goal_id_ + 1);
  sent_ = position;
  request_ = ExploreGoal{goal_id_, false, position};
  progress_ = now;
  arrived_ = 0;
}

bool Exploration::judge_goal(std::int64_t now, const Eigen::Vector2d& robot) {
  if (phase_ == Phase::kLooking || phase_ == Phase::kLastLook || !news_ || news_->goal_id != goal_id_) {
    return false;
  }
  if ((robot - stood_).norm() > kProgress) {
    stood_ = robot;
    progress_ = now;
  }
  if (news_->has_arrived && phase_ == Phase::kDriving) {
    arrived_ = arrived_ == 0 ? now : arrived_;
    return now - arrived_ >= microseconds_of(params_.dwell);
  }
  return news_->is_over || now - progress_ > microseconds_of(params_.patience);
}

}  // namespace luminav
