#include "services/common/image/jpeg_codec.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <stdexcept>

namespace luminav {

void JpegEncoder::Release::operator()(void* handle) const {
  tjDestroy(handle);
}
void JpegDecoder::Release::operator()(void* handle) const {
  tjDestroy(handle);
}

JpegEncoder::JpegEncoder() : handle_(tjInitCompress()) {
  if (handle_ == nullptr) {
    throw std::runtime_error("cannot make a JPEG encoder");
  }
}

std::span<const std::uint8_t> JpegEncoder::encode(const GreyView& image, int quality) {
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() < static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    return {};
  }
  const unsigned long largest = tjBufSize(image.width, image.height, TJSAMP_GRAY);
  if (largest == static_cast<unsigned long>(-1)) {
    return {};
  }
  if (buffer_.size() < largest) {
    buffer_.resize(largest);
  }
  unsigned char* data = buffer_.data();
  unsigned long size = buffer_.size();
  const int result = tjCompress2(handle_.get(), image.pixels.data(), image.width, image.width, image.height, TJPF_GRAY,
                                 &data, &size, TJSAMP_GRAY, std::clamp(quality, 1, 100), TJFLAG_NOREALLOC);
  return result == 0 ? std::span<const std::uint8_t>(buffer_.data(), size) : std::span<const std::uint8_t>{};
}

JpegDecoder::Handle JpegDecoder::make_decompressor() {
  Handle handle(tjInitDecompress());
  if (handle == nullptr) {
    throw std::runtime_error("cannot make a JPEG decoder");
  }
  return handle;
}

JpegDecoder::JpegDecoder(int width, int height) : handle_(make_decompressor()), width_(width), height_(height) {}

bool JpegDecoder::decode(std::span<const std::uint8_t> bytes, GreyImage& image) {
  if (read(bytes, image)) {
    return true;
  }
  // A handle that met a truncated header refuses sound files from then on (libturbojpeg 2.1.5).
  handle_ = make_decompressor();
  return false;
}

bool JpegDecoder::read(std::span<const std::uint8_t> bytes, GreyImage& image) {
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colour_space = 0;
  if (bytes.empty() || tjDecompressHeader3(handle_.get(), bytes.data(), bytes.size(), &width, &height, &subsampling,
                                           &colour_space) != 0) {
    return false;
  }
  if (width <= 0 || height <= 0 || width > kLargestSide || height > kLargestSide) {
    return false;
  }
  if ((width_ != 0 && width != width_) || (height_ != 0 && height != height_)) {
    return false;
  }
  image.width = width;
  image.height = height;
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  // libjpeg fills up what is missing and only warns, so a warning is a failure here.
  return tjDecompress2(handle_.get(), bytes.data(), bytes.size(), image.pixels.data(), width, width, height, TJPF_GRAY,
                       TJFLAG_STOPONWARNING) == 0;
}

}  // namespace luminav
