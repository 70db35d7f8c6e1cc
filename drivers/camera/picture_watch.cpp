#include "drivers/camera/picture_watch.hpp"

#include <algorithm>
#include <numeric>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

double mean_of(const GreyImage& image) {
  const auto sum = std::accumulate(image.pixels.begin(), image.pixels.end(), std::int64_t{0});
  return image.pixels.empty() ? 0.0 : static_cast<double>(sum) / static_cast<double>(image.pixels.size());
}

}  // namespace

void PictureWatch::look_at(const GreyImage& image, std::int64_t utime) {
  utime_ = utime;
  const double mean = mean_of(image);
  const auto bright = std::count_if(image.pixels.begin(), image.pixels.end(),
                                    [this](std::uint8_t pixel) { return pixel >= params_.structure_grey; });
  const bool shows_nothing = mean < params_.dark_grey &&
                             static_cast<double>(bright) < params_.structure * static_cast<double>(image.pixels.size());
  dark_since_ = !shows_nothing ? 0 : dark_since_ == 0 ? utime : dark_since_;
  // all black or all white is no sign: noise cannot be seen there
  const bool is_equal = !shows_nothing && mean < params_.white_grey && image.pixels == last_.pixels;
  equal_ = is_equal ? equal_ + 1 : 1;
  last_ = image;
}

bool PictureWatch::is_dark() const {
  return dark_since_ != 0 && seconds_between(dark_since_, utime_) > params_.dark_for;
}

std::string PictureWatch::complaint() const {
  if (is_frozen()) {
    return "the camera is frozen: it sends the same picture again and again";
  }
  return is_dark() ? "the camera sees nothing: it is covered, or all is dark" : "";
}

}  // namespace luminav
