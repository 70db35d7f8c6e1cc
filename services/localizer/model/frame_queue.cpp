#include "services/localizer/model/frame_queue.hpp"

namespace luminav {

void FrameQueue::add_frame(const SightingFrame& frame) {
  if (frame.utime <= last_used_ || (!waiting_.empty() && frame.utime <= waiting_.back().utime)) {
    ++dropped_;
    return;
  }
  waiting_.push_back(frame);
  if (waiting_.size() > kMaxWaiting) {
    waiting_.pop_front();
    ++dropped_;
  }
}

void FrameQueue::restart() {
  dropped_ += static_cast<std::int64_t>(waiting_.size());
  waiting_.clear();
  history_.clear();
  last_used_ = 0;
}

std::optional<FrameQueue::TimedFrame> FrameQueue::next() {
  // one from the future would keep out all that come after it
  while (!waiting_.empty() && !history_.is_empty() && waiting_.back().utime > history_.newest().utime + kMaxAhead) {
    waiting_.pop_back();
    ++dropped_;
  }
  while (!waiting_.empty() && !history_.is_empty() && waiting_.front().utime <= history_.newest().utime) {
    const std::optional<OdometryReading> odometry = history_.at(waiting_.front().utime);
    SightingFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    if (!odometry) {
      ++dropped_;  // older than the odometry kept
      continue;
    }
    last_used_ = frame.utime;
    return TimedFrame{std::move(frame), *odometry};
  }
  return std::nullopt;
}

}  // namespace luminav
