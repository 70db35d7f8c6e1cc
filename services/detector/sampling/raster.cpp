#include "services/detector/sampling/raster.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

/// One row of cells, from the sums of their columns, then of these two by two.
LUMINAV_VECTOR_CLONES
void reduce_row(const std::uint8_t* first, std::size_t stride, int factor, int gain, int width, std::uint16_t* sums,
                std::uint8_t* out) {
  std::copy_n(first, width, sums);
  for (int y = 1; y < factor; ++y) {
    const std::uint8_t* row = first + static_cast<std::size_t>(y) * stride;
    for (int x = 0; x < width; ++x) {
      sums[x] = static_cast<std::uint16_t>(sums[x] + row[x]);
    }
  }
  int cells = width;
  for (; cells * factor > width; cells /= 2) {
#pragma GCC ivdep
    for (int x = 0; x < cells / 2; ++x) {
      sums[x] = static_cast<std::uint16_t>(sums[2 * x] + sums[2 * x + 1]);
    }
  }
  const int shift = factor / 2 * 2;  // 1, 4, 16 pixels
  const int half = (1 << shift) / 2;
  for (int x = 0; x < cells; ++x) {
    out[x] = static_cast<std::uint8_t>(std::min((gain * sums[x] + half) >> shift, 255));
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

/// Running extreme over 2 radius + 1 cells in x, then in y, where the windows lie within the image; its cells are lost.
/// Windows of 1, 2, 4, ... cells are combined from two of half the size, so the cost grows with the logarithm of the
/// radius; every step is one straight loop over all rows. What it mixes from the next row lands in columns that are no
/// longer read.
void extreme_within(Raster& image, int radius, Combine combine, Raster& result) {
  const int window = 2 * radius + 1;
  const int stride = image.width;
  std::uint8_t* cells = image.cells.data();
  int count = static_cast<int>(image.cells.size());
  const auto combine_with = [&](int ahead) {
    count -= ahead;
    combine(cells, cells + ahead, count, cells);
  };
  int size = 1;
  for (; 2 * size <= window; size *= 2) {
    combine_with(size);
  }
  if (window > size) {
    combine_with(window - size);
  }
  count = image.height * stride;
  for (size = 1; 2 * size <= window; size *= 2) {
    combine_with(size * stride);
  }
  result.resize(image.width - 2 * radius, image.height - 2 * radius);
  for (int y = 0; y < result.height; ++y) {
    combine(image.row(y), image.row(y + window - size), result.width, result.row(y));
  }
}

/// The same of all cells: beyond the border all is `neutral`.
void running_extreme(const Raster& image, int radius, std::uint8_t neutral, Combine combine, Raster& result,
                     Raster& padded) {
  padded.resize(image.width + 2 * radius, image.height + 2 * radius);
  std::memset(padded.cells.data(), neutral, padded.cells.size());
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(padded.row(y + radius) + radius, image.row(y), static_cast<std::size_t>(image.width));
  }
  extreme_within(padded, radius, combine, result);
}

}  // namespace

LUMINAV_VECTOR_CLONES
void negate(std::span<const std::uint8_t> grey, std::vector<std::uint8_t>& result) {
  result.resize(grey.size());
  std::uint8_t* out = result.data();
#pragma GCC ivdep
  for (std::size_t i = 0; i < grey.size(); ++i) {
    out[i] = static_cast<std::uint8_t>(255 - grey[i]);
  }
}

void reduce(const GreyView& image, int factor, Raster& result, int gain) {
  result.resize(image.width / factor, image.height / factor);
  const auto stride = static_cast<std::size_t>(image.width);
  constexpr int kWidest = 8192;  // [px]
  std::array<std::uint16_t, kWidest> sums;
  const int width = std::min(result.width * factor, kWidest);
  for (int y = 0; y < result.height; ++y) {
    const std::uint8_t* first = image.pixels.data() + static_cast<std::size_t>(y * factor) * stride;
    reduce_row(first, stride, factor, gain, width, sums.data(), result.row(y));
  }
}

LUMINAV_VECTOR_CLONES
int cells_above(const Raster& image, int level) {
  const auto floor = static_cast<std::uint8_t>(level);
  constexpr std::size_t kChunk = 240;  // cells, which a byte can count
  std::size_t count = 0;
  for (std::size_t first = 0; first < image.cells.size(); first += kChunk) {
    const std::uint8_t* cells = image.cells.data() + first;
    const std::size_t size = std::min(kChunk, image.cells.size() - first);
    std::uint8_t of_chunk = 0;
    for (std::size_t i = 0; i < size; ++i) {
      of_chunk = static_cast<std::uint8_t>(of_chunk + (cells[i] > floor ? 1 : 0));
    }
    count += of_chunk;
  }
  return static_cast<int>(count);
}

LUMINAV_VECTOR_CLONES
int max_cell(const Raster& image) {
  std::uint8_t largest = 0;
  for (const std::uint8_t cell : image.cells) {
    largest = std::max(largest, cell);
  }
  return largest;
}

void dilate(const Raster& image, int radius, Raster& result, Raster& scratch) {
  running_extreme(image, radius, 0, larger_of, result, scratch);
}

void erode(const Raster& image, int radius, Raster& result, Raster& scratch) {
  running_extreme(image, radius, 255, smaller_of, result, scratch);
}

void dilate_within(Raster& image, int radius, Raster& result) {
  extreme_within(image, radius, larger_of, result);
}

void erode_within(Raster& image, int radius, Raster& result) {
  extreme_within(image, radius, smaller_of, result);
}

}  // namespace luminav
