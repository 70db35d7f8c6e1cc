#include "drivers/p3dx/line/send_queue.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr std::int64_t kFramePeriod = 5'000;  // [us] a robot may lose commands that follow faster
constexpr double kFrameBurst = 4.0;           // motion commands, and a change right behind them
constexpr std::size_t kLongestQueue = 64;

}  // namespace

void SendQueue::push(std::vector<std::uint8_t> frame) {
  if (waiting_.size() < kLongestQueue) {
    waiting_.push_back(std::move(frame));
  }
}

void SendQueue::flush(ByteStream* line, std::int64_t now) {
  allowance_ = std::min(kFrameBurst, allowance_ + static_cast<double>(now - allowance_at_) / kFramePeriod);
  allowance_at_ = now;
  while (line != nullptr && !waiting_.empty() && (allowance_ >= 1.0 || written_ > 0)) {
    // All that may leave goes in one write: on a network each costs as much as the rest of a poll.
    std::vector<std::uint8_t> batch(waiting_.front().begin() + static_cast<std::ptrdiff_t>(written_),
                                    waiting_.front().end());
    double left = written_ > 0 ? allowance_ : allowance_ - 1.0;
    for (std::size_t i = 1; i < waiting_.size() && left >= 1.0; ++i, left -= 1.0) {
      batch.insert(batch.end(), waiting_[i].begin(), waiting_[i].end());
    }
    const std::size_t count = line->write(batch);
    count_as_written(count, now);
    if (count < batch.size()) {
      return;  // goes on with the byte that was not taken
    }
  }
}

void SendQueue::count_as_written(std::size_t bytes, std::int64_t now) {
  while (bytes > 0) {
    if (written_ == 0) {
      allowance_ -= 1.0;
    }
    const std::size_t some = std::min(bytes, waiting_.front().size() - written_);
    bytes -= some;
    written_ += some;
    if (written_ == waiting_.front().size()) {
      written_ = 0;
      last_sent_ = now;
      waiting_.pop_front();
    }
  }
}

void SendQueue::finish_frame(ByteStream& line) const {
  if (written_ > 0) {
    line.write(std::span(waiting_.front()).subspan(written_));
  }
}

void SendQueue::drop_waiting(const ByteStream* line) {
  if (written_ > 0 && line != nullptr && line->is_open()) {
    waiting_.resize(1);
    return;
  }
  waiting_.clear();
  written_ = 0;
}

}  // namespace luminav
