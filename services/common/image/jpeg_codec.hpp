#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey JPEG by libturbojpeg; handle and buffer are kept, so that encoding allocates nothing once warm.
class JpegEncoder {
 public:
  JpegEncoder();

  /// The JPEG file of a picture at a quality of 1..100 (clamped); valid until the next call. Empty when the view has
  /// no pixels or fewer than width x height.
  [[nodiscard]] std::span<const std::uint8_t> encode(const GreyView& image, int quality);

 private:
  struct Release {
    void operator()(void* handle) const;
  };
  std::unique_ptr<void, Release> handle_;
  std::vector<std::uint8_t> buffer_;
};

/// Reads JPEG files, colour ones too, as grey.
class JpegDecoder {
 public:
  /// Larger pictures are refused: a damaged header must not cost gigabytes.
  static constexpr int kLargestSide = 8192;  // [px]

  /// Sides that are not these are refused by the header alone, before any work; 0 = any up to the largest.
  explicit JpegDecoder(int width = 0, int height = 0);

  /// False for anything that is not one whole, sound JPEG: truncated data and all of libjpeg's warnings count. Then
  /// the image's contents are undefined. Reuses the image's memory; never throws but for want of memory.
  [[nodiscard]] bool decode(std::span<const std::uint8_t> bytes, GreyImage& image);

 private:
  struct Release {
    void operator()(void* handle) const;
  };
  using Handle = std::unique_ptr<void, Release>;
  static Handle make_decompressor();
  bool read(std::span<const std::uint8_t> bytes, GreyImage& image);

  Handle handle_;
  int width_;   // [px] the only one; 0 = any
  int height_;  // [px]
};

}  // namespace luminav
