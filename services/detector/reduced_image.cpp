#include "services/detector/reduced_image.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

LUMINAV_VECTOR_CLONES
void add_rows(const std::uint8_t* first, std::size_t stride, int rows, int width, std::uint16_t* sums) {
  for (int x = 0; x < width; ++x) {
    sums[x] = first[x];
  }
  for (int y = 1; y < rows; ++y) {
    const std::uint8_t* row = first + static_cast<std::size_t>(y) * stride;
    for (int x = 0; x < width; ++x) {
      sums[x] = static_cast<std::uint16_t>(sums[x] + row[x]);
    }
  }
}

LUMINAV_VECTOR_CLONES
void fold_by_four(const std::uint16_t* sums, int cells, std::uint8_t* out) {
  for (int x = 0; x < cells; ++x) {
    const unsigned sum = static_cast<unsigned>(sums[4 * x]) + sums[4 * x + 1] + sums[4 * x + 2] + sums[4 * x + 3];
    out[x] = static_cast<std::uint8_t>((sum + 8U) >> 4);
  }
}

LUMINAV_VECTOR_CLONES
void fold_by_two(const std::uint16_t* sums, int cells, std::uint8_t* out) {
  for (int x = 0; x < cells; ++x) {
    out[x] = static_cast<std::uint8_t>((static_cast<unsigned>(sums[2 * x]) + sums[2 * x + 1] + 2U) >> 2);
  }
}

// The result may be written over `a` while `b` lies ahead of it: what is read was not yet written.
LUMINAV_VECTOR_CLONES
void larger_of(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* out) {
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    out[i] = std::max(a[i], b[i]);
  }
}

LUMINAV_VECTOR_CLONES
void smaller_of(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* out) {
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    out[i] = std::min(a[i], b[i]);
  }
}

using Combine = void (*)(const std::uint8_t*, const std::uint8_t*, int, std::uint8_t*);

/// Running extreme over 2 radius + 1 cells in x, then in y. Windows of 1, 2, 4, ... cells are combined from two of half
/// the size, so the cost grows with the logarithm of the radius and every step is one straight loop.
void running_extreme(const Raster& image, int radius, std::uint8_t neutral, Combine combine, Raster& result,
                     Raster& padded) {
  const int window = 2 * radius + 1;
  const int width = image.width;
  const int height = image.height;
  padded.resize(width + 2 * radius, height + 2 * radius);
  std::fill(padded.cells.begin(), padded.cells.end(), neutral);
  const auto inner = static_cast<std::size_t>(width);
  for (int y = 0; y < height; ++y) {
    std::uint8_t* row = padded.row(y + radius);
    std::memcpy(row + radius, image.row(y), inner);
    int size = 1;
    int count = padded.width;
    for (; 2 * size <= window; size *= 2) {
      count -= size;
      combine(row, row + size, count, row);
    }
    combine(row, row + (window - size), width, row);
  }
  const int stride = padded.width;
  int size = 1;
  int rows = padded.height;
  for (; 2 * size <= window; size *= 2) {
    rows -= size;
    for (int y = 0; y < rows; ++y) {
      std::uint8_t* row = padded.row(y);
      combine(row, row + static_cast<std::ptrdiff_t>(size) * stride, width, row);
    }
  }
  result.resize(width, height);
  for (int y = 0; y < height; ++y) {
    combine(padded.row(y), padded.row(y + window - size), width, result.row(y));
  }
}

}  // namespace

void reduce(const GreyView& image, int factor, Raster& result) {
  result.resize(image.width / factor, image.height / factor);
  const auto stride = static_cast<std::size_t>(image.width);
  if (factor == 1) {
    std::copy_n(image.pixels.data(), result.cells.size(), result.cells.data());
    return;
  }
  constexpr int kWidest = 8192;  // [px]
  std::array<std::uint16_t, kWidest> sums;
  const int width = std::min(result.width * factor, kWidest);
  for (int y = 0; y < result.height; ++y) {
    const std::uint8_t* first = image.pixels.data() + static_cast<std::size_t>(y * factor) * stride;
    add_rows(first, stride, factor, width, sums.data());
    if (factor == 4) {
      fold_by_four(sums.data(), width / 4, result.row(y));
    } else {
      fold_by_two(sums.data(), width / 2, result.row(y));
    }
  }
}

void dilate(const Raster& image, int radius, Raster& result, Raster& scratch) {
  running_extreme(image, radius, 0, larger_of, result, scratch);
}

void erode(const Raster& image, int radius, Raster& result, Raster& scratch) {
  running_extreme(image, radius, 255, smaller_of, result, scratch);
}

}  // namespace luminav
