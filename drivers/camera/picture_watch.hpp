#pragma once

#include <cstdint>
#include <string>

#include "services/common/image/grey_image.hpp"

namespace luminav {

struct PictureWatchParams {
  int equal_pictures = 5;     // in a row: the sensor's noise never draws the same picture twice
  double dark_grey = 8.0;     // [grey levels] mean of a picture that shows nothing,
  int structure_grey = 40;    // and in which next to no pixel is as bright
  double structure = 0.0005;  // share of the pixels that are
  double white_grey = 250.0;  // [grey levels] mean of one that is all white: it may come twice
  double dark_for = 1.5;      // [s] longer than the exposure takes after somebody switched the light off
};

/// Looks for pictures that show nothing of the ceiling: always the same one, or none in the dark.
class PictureWatch {
 public:
  explicit PictureWatch(const PictureWatchParams& params) : params_(params) {}

  /// Pictures in the order of their stamps [us].
  void look_at(const GreyImage& image, std::int64_t utime);
  [[nodiscard]] bool is_frozen() const { return equal_ >= params_.equal_pictures; }
  [[nodiscard]] bool is_dark() const;
  /// One plain sentence; "" when the pictures are alive.
  [[nodiscard]] std::string complaint() const;

 private:
  PictureWatchParams params_;
  GreyImage last_;
  int equal_ = 0;                // pictures in a row, 1 = the last was new
  std::int64_t utime_ = 0;       // [us]
  std::int64_t dark_since_ = 0;  // [us] 0 = it is not
};

}  // namespace luminav
