#include "services/planner/execution/search_effort.hpp"

namespace luminav {

void SearchEffort::reset() {
  first_length_ = driven_ = 0.0;
  last_.reset();
}

void SearchEffort::drive_to(const Eigen::Vector2d& robot) {
  driven_ += (robot - last_.value_or(robot)).norm();
  last_ = robot;
}

bool SearchEffort::is_in_vain() const {
  return first_length_ > 0.0 && driven_ > ratio_ * first_length_ + length_;
}

}  // namespace luminav
