#include "services/common/building/map_picture.hpp"

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "services/common/configuration/configuration_error.hpp"

namespace luminav {
namespace {

constexpr int kMaxSide = 20'000;             // [px]
constexpr std::size_t kMaxPng = 64'000'000;  // [px] it is unpacked as a whole, into two bytes each

/// libpng cleans up whatever ends the reading.
struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(this); }
};

}  // namespace

MapPicture::MapPicture(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code failure;
  if (std::filesystem::is_regular_file(file_, failure)) {  // a folder has no bytes, and a pipe none yet
    in_.open(file_, std::ios::binary);
  }
  if (!in_.is_open() || !in_) {
    fail("cannot be read");
  }
  std::array<char, 2> magic{};
  in_.read(magic.data(), magic.size());
  if (magic == std::array{'P', '5'}) {
    open_pgm();
  } else if (magic == std::array{'\x89', 'P'}) {
    open_png();
  } else {
    fail("must be a PNG or a binary PGM picture (P5)");
  }
  row_.resize(static_cast<std::size_t>(width_));
}

void MapPicture::fail(const std::string& what) const {
  throw ConfigurationError(fmt::format("{}: {}", file_.string(), what));
}

void MapPicture::check_size() const {
  if (width_ > kMaxSide || height_ > kMaxSide) {
    fail(fmt::format("{} x {} px, must be at most {} x {}", width_, height_, kMaxSide, kMaxSide));
  }
}

/// Comments run from # to the end of the line.
int MapPicture::read_header_number() {
  while (true) {
    const int next = in_.peek();
    if (next == '#') {
      std::string comment;
      std::getline(in_, comment);
    } else if (std::isspace(next) != 0) {
      in_.get();
    } else {
      break;
    }
  }
  int number = 0;
  if (!(in_ >> number) || number <= 0) {
    fail("not a binary PGM picture (P5)");
  }
  return number;
}

void MapPicture::open_pgm() {
  width_ = read_header_number();
  height_ = read_header_number();
  max_ = read_header_number();
  if (max_ > 255) {
    fail("16-bit PGM, must be 8-bit");
  }
  check_size();
  in_.get();
}

void MapPicture::open_png() {
  PngImage image;
  if (png_image_begin_read_from_file(&image, file_.c_str()) == 0) {
    fail(fmt::format("not a whole PNG picture: {}", image.message));
  }
  width_ = static_cast<int>(image.width);  // libpng takes none of 2^31 and more
  height_ = static_cast<int>(image.height);
  check_size();
  const std::size_t count = std::size_t{image.width} * image.height;
  if (count > kMaxPng) {
    fail(fmt::format("{} x {} px are too many for a PNG, give a PGM", width_, height_));
  }
  image.format = PNG_FORMAT_GA;
  png_.resize(2 * count);
  if (png_image_finish_read(&image, nullptr, png_.data(), 0, nullptr) == 0) {
    fail(fmt::format("not a whole PNG picture: {}", image.message));
  }
}

std::span<const MapPixel> MapPicture::next_row() {
  if (!png_.empty()) {
    const std::uint8_t* pairs = png_.data() + 2 * static_cast<std::size_t>(rows_read_) * row_.size();
    for (MapPixel& pixel : row_) {
      pixel = {pairs[0], pairs[1]};
      pairs += 2;
    }
  } else {
    std::vector<std::uint8_t> bytes(row_.size());
    in_.read(reinterpret_cast<char*>(bytes.data()), width_);
    if (in_.gcount() != width_) {
      fail(fmt::format("cut off, {} of {} pixels", static_cast<std::int64_t>(rows_read_) * width_ + in_.gcount(),
                       static_cast<std::int64_t>(height_) * width_));
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      row_[i] = {static_cast<std::uint8_t>(bytes[i] >= max_ ? 255 : bytes[i] * 255 / max_), 255};
    }
  }
  ++rows_read_;
  return row_;
}

}  // namespace luminav
