#include "services/planner/execution/pose_losses.hpp"

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kForgotten = 1.0;  // [m] of progress after which losses count from zero again

}  // namespace

bool PoseLosses::is_brief(std::int64_t now) const {
  return last_tracking_ != 0 && seconds_of(now - last_tracking_) < params_.tracking_grace;
}

bool PoseLosses::count(double distance_left) {
  if (losses_ == 0 || distance_left < loss_left_ - kForgotten) {
    losses_ = 0;
    loss_left_ = distance_left;
  }
  return ++losses_ <= params_.losses;
}

}  // namespace luminav
