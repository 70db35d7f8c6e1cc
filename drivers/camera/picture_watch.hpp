#pragma once

#include <cstdint>
#include <string>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Looks for pictures that show nothing of the ceiling: always the same one, or none in the dark.
class PictureWatch {
 public:
  /// Pictures in the order of their stamps [us].
  void look_at(const GreyImage& image, std::int64_t utime);
  [[nodiscard]] bool is_frozen() const;
  [[nodiscard]] bool is_dark() const;
  /// One plain sentence; "" when the pictures are alive.
  [[nodiscard]] std::string complaint() const;

 private:
  GreyImage last_;
  int equal_ = 0;                // pictures in a row, 1 = the last was new
  std::int64_t utime_ = 0;       // [us]
  std::int64_t dark_since_ = 0;  // [us] 0 = it is not
};

}  // namespace luminav
