#include "services/surveyor/explore/exploration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kSamePlace = 0.5;  // [m] two goals that failed there are one
constexpr double kProgress = 0.3;   // [m] of the way that count as coming nearer

}  // namespace

void Exploration::begin() {
  *this = Exploration(params_);
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
  if (is_active() && goal_id_ != 0 && news.goal_id > goal_id_) {
    phase_ = Phase::kIdle;
    sentence_ = "exploring ended: somebody else told the robot what to do; the survey goes on";
  }
}

bool Exploration::is_due(std::int64_t now) const {
  return is_active() && (now < searched_ || now - searched_ >= microseconds_of(params_.search_period));
}

void Exploration::update(std::int64_t now, const Surroundings& around) {
  searched_ = now;
  const bool has_moved = around.drawing != drawing_;
  drawing_ = around.drawing;
  const bool is_over = judge_goal(now);
  if (phase_ == Phase::kHome) {
    drive_home(now, is_over, has_moved);
    return;
  }
  const FrontierSearch found(params_.search, around.grid, params_.walls[wall_], around.looks, given_up(),
                             around.world_from_robot.position());
  floor_ = found.open_floor();
  const bool is_spent = phase_ == Phase::kDriving && found.gain_of(hoped_) < params_.spent_share * goal_.gain;
  if (phase_ == Phase::kDriving && (is_over || is_spent)) {
    attempts_.push_back(goal_.position);
  }
  if (phase_ == Phase::kDriving && !is_spent && !is_over && !has_moved) {
    return;
  }
  if (is_over && !is_spent) {
    note_failure(now, found);
  } else if (is_spent && wall_ > 0) {
    wall_ = 0;  // a door it was
    phase_ = Phase::kLooking;
  } else {
    choose(now, found);
  }
}

void Exploration::choose(std::int64_t now, const FrontierSearch& found) {
  if (floor_.best && attempts_at(floor_.best->position) >= params_.max_attempts) {
    // echoes that come and go open and close the same corner for ever
    failures_.push_back({found.open_cells(floor_.best->position), drawing_, true});
    phase_ = Phase::kLooking;
  } else if (floor_.best) {
    goal_ = *floor_.best;
    hoped_ = found.open_cells(goal_.position);
    looks_closer_ = false;
    empty_ = 0;
    phase_ = Phase::kDriving;
    go(now, goal_.position);
    sentence_ = fmt::format("exploring: {} open ends, {:.0f} of {:.0f} m2 of ceiling seen; driving to ({:.1f}, {:.1f})",
                            floor_.frontiers, floor_.reachable - floor_.unseen, floor_.reachable, goal_.position.x(),
                            goal_.position.y());
  } else if (++empty_ < params_.looks) {
    phase_ = Phase::kLooking;
  } else if (wall_ + 1 < params_.walls.size()) {
    ++wall_;
    empty_ = 0;
    phase_ = Phase::kLooking;
  } else {
    phase_ = Phase::kHome;
    go(now, Eigen::Vector2d::Zero());
    sentence_ =
        fmt::format("exploring: nothing is left that can be reached, {:.0f} m2; driving home", floor_.reachable);
  }
}

void Exploration::drive_home(std::int64_t now, bool is_over, bool has_moved) {
  if (is_over) {
    phase_ = Phase::kFinished;
    sentence_ = news_->has_arrived ? "explored, and back where it began"
                                   : "explored; the robot did not come back to where it began: " + news_->cause;
  } else if (has_moved) {
    go(now, Eigen::Vector2d::Zero());
  }
}

void Exploration::go(std::int64_t now, const Eigen::Vector2d& position) {
  goal_id_ = std::max(now, goal_id_ + 1);
  request_ = ExploreGoal{goal_id_, false, position};
  min_left_ = 0.0;
  progress_ = now;
}

bool Exploration::judge_goal(std::int64_t now) {
  if (phase_ == Phase::kLooking || !news_ || news_->goal_id != goal_id_) {
    return false;
  }
  if (news_->is_paused) {
    progress_ = now;
    return false;
  }
  if (min_left_ <= 0.0 || news_->distance_left < min_left_ - kProgress) {
    min_left_ = news_->distance_left;
    progress_ = now;
  }
  return news_->is_over || now - progress_ > microseconds_of(params_.patience);
}

void Exploration::note_failure(std::int64_t now, const FrontierSearch& found) {
  std::vector<Eigen::Vector2d> cells = found.still_open(hoped_);
  if (news_->has_arrived && !looks_closer_ && !cells.empty()) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& cell : cells) {
      middle += cell / static_cast<double>(cells.size());
    }
    // silence takes nothing away along a smooth wall: what is not heard from there is to be driven into
    const Eigen::Vector2d nearest =
        *std::min_element(cells.begin(), cells.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
          return (a - middle).squaredNorm() < (b - middle).squaredNorm();
        });
    looks_closer_ = true;
    go(now, nearest);
    return;
  }
  failures_.push_back({std::move(cells), drawing_, attempts_at(goal_.position) > 1 || news_->has_arrived});
  phase_ = Phase::kLooking;
}

int Exploration::attempts_at(const Eigen::Vector2d& position) const {
  return static_cast<int>(std::count_if(attempts_.begin(), attempts_.end(), [&](const Eigen::Vector2d& attempt) {
    return (attempt - position).norm() < kSamePlace;
  }));
}

std::vector<Eigen::Vector2d> Exploration::given_up() const {
  std::vector<Eigen::Vector2d> cells;
  for (const Failure& failure : failures_) {
    if (failure.is_final || failure.drawing == drawing_) {
      cells.insert(cells.end(), failure.cells.begin(), failure.cells.end());
    }
  }
  return cells;
}

}  // namespace luminav
