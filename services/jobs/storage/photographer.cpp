#include "services/jobs/storage/photographer.hpp"

#include "services/common/process/channels.hpp"

namespace luminav {

void Photographer::tick(std::int64_t now) {
  const bool wants = executor_.wanted_photo().has_value();
  if (wants && !camera_) {
    since_ = now;
    camera_.emplace(lcm_);
    camera_->on(channels::kCameraImage, &Photographer::on_camera_image, this);
  } else if (!wants) {
    camera_.reset();
  }
}

void Photographer::on_camera_image(const camera_image_t& message) {
  const std::optional<PhotoWish> wish = executor_.wanted_photo();
  if (!wish || message.utime < since_) {
    return;  // one that was taken on the way
  }
  try {
    photos_.keep(message, *wish, inputs_.pose_at(message.utime));
    error_.clear();
  } catch (const std::exception& error) {
    error_ = error.what();
  }
  executor_.end_photo();
}

}  // namespace luminav
