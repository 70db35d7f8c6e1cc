#include "drivers/camera/picture_watch.hpp"

#include <algorithm>
#include <numeric>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr int kEqualPictures = 5;      // in a row: the sensor's noise never draws the same picture twice
constexpr double kDarkGrey = 8.0;      // [grey levels] mean of a picture that shows nothing,
constexpr int kStructureGrey = 40;     // and in which next to no pixel is as bright
constexpr double kStructure = 0.0005;  // share of the pixels that are
constexpr double kWhiteGrey = 250.0;   // [grey levels] mean of one that is all white: it may come twice
constexpr double kDarkFor = 1.5;       // [s] longer than the exposure takes after somebody switched the light off

double mean_of(const GreyImage& image) {
  const auto sum = std::accumulate(image.pixels.begin(), image.pixels.end(), std::int64_t{0});
  return image.pixels.empty() ? 0.0 : static_cast<double>(sum) / static_cast<double>(image.pixels.size());
}

bool has_structure(const GreyImage& image) {
  const double enough = kStructure * static_cast<double>(image.pixels.size());
  int bright = 0;
  return std::any_of(image.pixels.begin(), image.pixels.end(), [&](std::uint8_t pixel) {
    bright += pixel >= kStructureGrey ? 1 : 0;
    return bright >= enough;
  });
}

}  // namespace

void PictureWatch::look_at(const GreyImage& image, std::int64_t utime) {
  utime_ = utime;
  // of an ordinary picture both questions are answered by its first pixels
  const bool shows_nothing = !has_structure(image) && mean_of(image) < kDarkGrey;
  dark_since_ = !shows_nothing ? 0 : dark_since_ == 0 ? utime : dark_since_;
  // all black or all white is no sign: noise cannot be seen there
  const bool is_equal = image.pixels == last_.pixels && !shows_nothing && mean_of(image) < kWhiteGrey;
  equal_ = is_equal ? equal_ + 1 : 1;
  last_ = image;
}

bool PictureWatch::is_frozen() const {
  return equal_ >= kEqualPictures;
}

bool PictureWatch::is_dark() const {
  return dark_since_ != 0 && seconds_between(dark_since_, utime_) > kDarkFor;
}

std::string PictureWatch::complaint() const {
  if (is_frozen()) {
    return "the camera is frozen: it sends the same picture again and again";
  }
  return is_dark() ? "the camera sees nothing: it is covered, or all is dark" : "";
}

}  // namespace luminav
