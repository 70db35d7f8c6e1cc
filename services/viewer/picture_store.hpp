#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

namespace luminav {

/// The newest camera pictures as JPEG files, shared between the thread that receives and those that serve. A page on a
/// slow link asks for one of them when its successor is there already.
class PictureStore {
 public:
  using Jpeg = std::shared_ptr<const std::string>;
  static constexpr std::size_t kKept = 3;

  void put(std::int32_t sequence, std::string jpeg) {
    auto shared = std::make_shared<const std::string>(std::move(jpeg));
    const std::lock_guard lock(mutex_);
    pictures_.push_front({sequence, std::move(shared)});
    if (pictures_.size() > kKept) {
      pictures_.pop_back();
    }
  }
  /// Null before the first one.
  [[nodiscard]] Jpeg newest() const {
    const std::lock_guard lock(mutex_);
    return pictures_.empty() ? nullptr : pictures_.front().jpeg;
  }
  /// The one with this sequence number of CAMERA_IMAGE; null when it is not there, or not any more.
  [[nodiscard]] Jpeg find(std::int32_t sequence) const {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(pictures_.begin(), pictures_.end(), [&](const Picture& p) { return p.sequence == sequence; });
    return found == pictures_.end() ? nullptr : found->jpeg;
  }

 private:
  struct Picture {
    std::int32_t sequence;
    Jpeg jpeg;
  };
  mutable std::mutex mutex_;
  std::deque<Picture> pictures_;  // newest first
};

}  // namespace luminav
