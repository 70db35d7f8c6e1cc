#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

namespace luminav {

/// The newest camera picture as a JPEG file, shared between the thread that receives and those that serve.
class PictureStore {
 public:
  using Jpeg = std::shared_ptr<const std::string>;

  void put(std::string jpeg) {
    auto shared = std::make_shared<const std::string>(std::move(jpeg));
    const std::lock_guard lock(mutex_);
    newest_ = std::move(shared);
  }
  /// Null before the first one.
  [[nodiscard]] Jpeg newest() const {
    const std::lock_guard lock(mutex_);
    return newest_;
  }

 private:
  mutable std::mutex mutex_;
  Jpeg newest_;
};

}  // namespace luminav
