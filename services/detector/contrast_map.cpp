#include "services/detector/contrast_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/grey_counts.hpp"

namespace luminav {
namespace {

static_assert(std::endian::native == std::endian::little);  // the left one of two cells is the lower byte

constexpr int kCap = 6;  // [grey] by which the ceiling may rise above its own opening (tiles, their joints)

/// Whole vectors in place of `count` cells of a row: what is mixed in from the rows behind lands where those are
/// written later. Where too little is behind them, `count`; the last two rows are never touched.
int whole_vectors(int count, const Raster& raster, int row) {
  constexpr int kVector = 32;
  return (raster.height - 2 - row) * raster.width >= kVector ? (count + kVector - 1) / kVector * kVector : count;
}

/// Twice the size in x and y by linear interpolation between cell centres; nothing is invented beyond the border. All
/// in 16 bits, and two cells are written at once: the compiler then finds vectors of them.
LUMINAV_VECTOR_CLONES
void enlarge(const Raster& half, int width, int height, Raster& result) {
  constexpr int kWidest = 4096;
  constexpr int kBeyond = 32;                           // what lies beyond the border is like the last
  std::array<std::uint16_t, kWidest + kBeyond> column;  // four times the grey between two rows
  const int cells = std::min(half.width, kWidest);
  result.resize(width, height);
  for (int y = 0; y < height; ++y) {
    const int near_row = std::min(y / 2, half.height - 1);
    const int far_row = std::clamp(y % 2 == 0 ? near_row - 1 : near_row + 1, 0, half.height - 1);
    const std::uint8_t* a = half.row(near_row);
    const std::uint8_t* b = half.row(far_row);
    std::uint16_t* c = column.data();
    const int mixed = std::min(whole_vectors(cells, half, std::max(near_row, far_row)), kWidest);
#pragma GCC ivdep
    for (int i = 0; i < mixed; ++i) {
      c[i] = static_cast<std::uint16_t>(3 * a[i] + b[i]);
    }
    std::fill_n(c + cells, kBeyond, c[cells - 1]);
    std::uint8_t* out = result.row(y);
    out[0] = static_cast<std::uint8_t>((4 * c[0] + 8) >> 4);
    const int pairs = std::min(whole_vectors(width - 1, result, y) / 2, cells + kBeyond - 1);
#pragma GCC ivdep
    for (int i = 0; i < pairs; ++i) {
      const auto left = static_cast<std::uint16_t>(3 * c[i] + c[i + 1] + 8);
      const auto right = static_cast<std::uint16_t>(c[i] + 3 * c[i + 1] + 8);
      const auto pair = static_cast<std::uint16_t>((left >> 4) | ((right >> 4) << 8));
      std::memcpy(out + 1 + 2 * i, &pair, sizeof pair);
    }
    for (int x = 2 * pairs + 1; x < width; ++x) {
      out[x] = static_cast<std::uint8_t>((4 * c[cells - 1] + 8) >> 4);
    }
  }
}

std::uint8_t continued(int edge, int mirrored) {
  return static_cast<std::uint8_t>(std::clamp(2 * edge - mirrored, 0, 255));
}

/// Continues a row by `margin` cells to both sides; nothing else may be written there.
LUMINAV_VECTOR_CLONES
void continue_row(const std::uint8_t* row, int width, int margin, std::uint8_t* out) {
  const int last = width - 1;
  const int inside = std::min(margin, last);  // cells that are mirrored; beyond them the last is repeated
  std::uint8_t* left = out - inside;
  std::uint8_t* right = out + width;
#pragma GCC ivdep
  for (int i = 0; i < inside; ++i) {
    left[i] = continued(row[0], row[inside - i]);
  }
#pragma GCC ivdep
  for (int i = 0; i < inside; ++i) {
    right[i] = continued(row[last], row[last - 1 - i]);
  }
  std::fill_n(out - margin, margin - inside, continued(row[0], row[last]));
  std::fill_n(right + inside, margin - inside, continued(row[last], row[0]));
}

LUMINAV_VECTOR_CLONES
void continue_column(const std::uint8_t* edge, const std::uint8_t* mirrored, int width, std::uint8_t* out) {
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    out[x] = continued(edge[x], mirrored[x]);
  }
}

/// Continues the image beyond its borders point-symmetrically, so that a slope stays a slope there. Without it the
/// surroundings of a border cell would all lie on one side, and shading alone would give it contrast.
void continue_beyond(const Raster& image, int margin, Raster& result) {
  result.resize(image.width + 2 * margin, image.height + 2 * margin);
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* out = result.row(y + margin) + margin;
    std::copy_n(image.row(y), image.width, out);
    continue_row(image.row(y), image.width, margin, out);
  }
  const int last = image.height - 1;
  const std::uint8_t* top = result.row(margin);
  const std::uint8_t* bottom = result.row(margin + last);
  for (int i = 1; i <= margin; ++i) {
    continue_column(top, result.row(margin + std::min(i, last)), result.width, result.row(margin - i));
    continue_column(bottom, result.row(margin + std::max(last - i, 0)), result.width, result.row(margin + last + i));
  }
}

constexpr int kMostExact = 1 << 14;  // cells of a window

/// Means of windows of up to `kMostExact` cells, rounded; `per_cell` are the areas' inverses.
LUMINAV_VECTOR_CLONES
void divide(const std::uint32_t* sums, const std::uint32_t* areas, const float* per_cell, int count,
            std::uint8_t* out) {
#pragma GCC ivdep
  for (int x = 0; x < count; ++x) {
    // Exact: half a cell's share away from the next whole number is farther than the product may be off.
    const auto sum = static_cast<float>(static_cast<std::int32_t>(sums[x] + areas[x] / 2)) + 0.5F;
    out[x] = static_cast<std::uint8_t>(static_cast<std::int32_t>(sum * per_cell[x]));
  }
}

LUMINAV_VECTOR_CLONES
void subtract(const std::uint32_t* a, const std::uint32_t* b, int count, std::uint32_t* out) {
#pragma GCC ivdep
  for (int x = 0; x < count; ++x) {
    out[x] = a[x] - b[x];
  }
}

/// Cells in the windows of a row, and their inverses.
LUMINAV_VECTOR_CLONES
void measure_windows(int reach, std::uint32_t rows, int width, std::uint32_t* areas, float* per_cell) {
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    const int to_border = x < width - 1 - x ? x : width - 1 - x;
    const auto columns = static_cast<std::uint32_t>(2 * (reach < to_border ? reach : to_border) + 1);
    areas[x] = columns * rows;
    per_cell[x] = 1.0F / static_cast<float>(static_cast<std::int32_t>(areas[x]));
  }
}

/// Means over 2 radius + 1 cells in x and y; beyond the border the window is cut off on both sides alike, so that a
/// slope is its own mean everywhere.
void average(const Raster& image, int radius, Raster& result, std::vector<std::uint32_t>& sums,
             std::vector<float>& per_cell) {
  const int width = image.width;
  const int height = image.height;
  const auto stride = static_cast<std::size_t>(width) + 1;
  const std::size_t table = stride * (static_cast<std::size_t>(height) + 1);
  sums.resize(table + 3 * stride);
  std::fill_n(sums.begin(), stride, 0U);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* in = image.row(y);
    const std::uint32_t* above = sums.data() + static_cast<std::size_t>(y) * stride;
    std::uint32_t* below = sums.data() + static_cast<std::size_t>(y + 1) * stride;
    below[0] = 0;
    std::uint32_t row_sum = 0;
#pragma GCC unroll 8
    for (int x = 0; x < width; ++x) {
      row_sum += in[x];
      below[x + 1] = above[x + 1] + row_sum;
    }
  }
  std::uint32_t* columns = sums.data() + table;  // sums of the window's rows, from the left border on
  std::uint32_t* windows = columns + stride;
  std::uint32_t* areas = windows + stride;
  const int reach = std::min(radius, (width - 1) / 2);
  const bool small = static_cast<std::int64_t>(2 * radius + 1) * (2 * radius + 1) < kMostExact;
  per_cell.resize(stride);
  std::uint32_t rows = 0;
  result.resize(width, height);
  for (int y = 0; y < height; ++y) {
    const int ry = std::min({radius, y, height - 1 - y});
    if (rows != static_cast<std::uint32_t>(2 * ry + 1)) {
      rows = static_cast<std::uint32_t>(2 * ry + 1);
      measure_windows(reach, rows, width, areas, per_cell.data());
    }
    subtract(sums.data() + static_cast<std::size_t>(y + ry + 1) * stride,
             sums.data() + static_cast<std::size_t>(y - ry) * stride, width + 1, columns);
    for (int x = 0; x < reach; ++x) {
      const int mirrored = width - 1 - x;
      windows[x] = columns[2 * x + 1];
      windows[mirrored] = columns[width] - columns[mirrored - x];
    }
    subtract(columns + 2 * reach + 1, columns, width - 2 * reach, windows + reach);
    std::uint8_t* out = result.row(y);
    if (small) {
      divide(windows, areas, per_cell.data(), width, out);
    } else {
      for (int x = 0; x < width; ++x) {
        out[x] = static_cast<std::uint8_t>((windows[x] + areas[x] / 2) / areas[x]);
      }
    }
  }
}

constexpr int kFlatLevel = 128;  // [grey] of a flattened image

LUMINAV_VECTOR_CLONES
void flatten(std::uint8_t* image, const std::uint8_t* mean, std::size_t count) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    image[i] = static_cast<std::uint8_t>(std::clamp(kFlatLevel + image[i] - mean[i], 0, 255));
  }
}

LUMINAV_VECTOR_CLONES
void unflatten(std::uint8_t* image, const std::uint8_t* mean, int count) {
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    image[i] = static_cast<std::uint8_t>(std::clamp(image[i] + mean[i] - kFlatLevel, 0, 255));
  }
}

LUMINAV_VECTOR_CLONES
void difference(const std::uint8_t* a, const std::uint8_t* b, std::size_t count, std::uint8_t* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = static_cast<std::uint8_t>(std::max(a[i], b[i]) - b[i]);
  }
}

LUMINAV_VECTOR_CLONES
void cap(const std::uint8_t* image, const std::uint8_t* level, std::size_t count, std::uint8_t* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const auto top = static_cast<std::uint8_t>(std::min<std::uint8_t>(level[i], 255 - kCap) + kCap);
    out[i] = std::min(image[i], top);
  }
}

void saturating_difference(const Raster& minuend, const Raster& subtrahend, Raster& result) {
  result.resize(minuend.width, minuend.height);
  difference(minuend.cells.data(), subtrahend.cells.data(), result.cells.size(), result.cells.data());
}

/// By how much means of 3 x 3 cells, the border repeated, stay below `level`.
LUMINAV_VECTOR_CLONES
void sink_below(const Raster& level, const Raster& image, Raster& result) {
  result.resize(image.width, image.height);
  constexpr int kWidest = 8192;
  std::array<std::uint16_t, kWidest + 2> padded;
  std::uint16_t* sums = padded.data() + 1;
  const int last = std::min(image.width, kWidest) - 1;
  const auto depth = [](std::uint8_t top, std::uint8_t mean) {
    return static_cast<std::uint8_t>(std::max(top, mean) - mean);
  };
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* above = image.row(std::max(y - 1, 0));
    const std::uint8_t* here = image.row(y);
    const std::uint8_t* below = image.row(std::min(y + 1, image.height - 1));
    const int count = std::min(whole_vectors(image.width, image, y + 1), kWidest);
#pragma GCC ivdep
    for (int x = 0; x < count; ++x) {
      sums[x] = static_cast<std::uint16_t>(above[x] + here[x] + below[x]);
    }
    sums[-1] = sums[count] = 0;  // only to be read
    const std::uint8_t* top = level.row(y);
    std::uint8_t* out = result.row(y);
    const std::uint16_t* s = sums;
#pragma GCC ivdep
    for (int x = 0; x < count; ++x) {
      // 7282 / 65536 = 1 / 9
      const auto sum = static_cast<std::uint16_t>(s[x - 1] + s[x] + s[x + 1] + 4);
      out[x] = depth(top[x], static_cast<std::uint8_t>(static_cast<std::uint16_t>((sum * 7282U) >> 16)));
    }
    out[0] = depth(top[0], static_cast<std::uint8_t>((2 * s[0] + s[1] + 4) / 9));
    out[last] = depth(top[last], static_cast<std::uint8_t>((2 * s[last] + s[last - 1] + 4) / 9));
  }
}

LUMINAV_VECTOR_CLONES
void take_steps(const std::uint8_t* row, int count, std::uint8_t* steps) {
#pragma GCC ivdep
  for (int x = 0; x < count; ++x) {
    steps[x] = static_cast<std::uint8_t>(std::max(row[x], row[x + 1]) - std::min(row[x], row[x + 1]));
  }
}

/// Median absolute difference of horizontal neighbours, over every seventh row, as a standard deviation.
double noise_of(const Raster& image, std::vector<std::uint8_t>& steps) {
  constexpr double kLeast = 0.3;
  steps.resize(static_cast<std::size_t>((image.height + 3) / 7 * (image.width - 1)));
  std::uint8_t* end = steps.data();
  for (int y = 3; y < image.height; y += 7) {
    take_steps(image.row(y), image.width - 1, end);
    end += image.width - 1;
  }
  const auto up_to = [&](int level) {
    return level < 0 ? 0 : count_up_to(steps.data(), steps.size(), static_cast<std::uint8_t>(level));
  };
  const double half = 0.5 * static_cast<double>(steps.size());
  const int median = median_level(1, [&](int level) { return up_to(level) >= half; });
  // median of |a - b| = 0.954 sigma of one; linear within the grey level
  const int below = up_to(median - 1);
  const double inside = (half - below) / std::max(up_to(median) - below, 1);
  return std::max(kLeast, (static_cast<double>(median) - 0.5 + inside) / 0.954);
}

}  // namespace

void ContrastMap::compute(const Raster& image, int radius, bool ignore_lines) {
  noise_ = noise_of(image, steps_);
  const int half_radius = std::max(1, (radius + 1) / 2);
  const Raster* clean = &image;
  if (ignore_lines) {
    dilate(image, 1, dilated_, scratch_);
    erode(dilated_, 1, clean_, scratch_);
    clean = &clean_;
  }
  reduce({clean->width, clean->height, clean->cells}, 2, half_);
  const int margin = 2 * half_radius;
  continue_beyond(half_, margin, wide_);
  erode(wide_, half_radius, eroded_, scratch_);
  dilate(eroded_, half_radius, wide_opened_, scratch_);
  capped_.resize(wide_.width, wide_.height);
  const std::size_t count = wide_.cells.size();
  cap(wide_.cells.data(), wide_opened_.cells.data(), count, capped_.cells.data());
  // A closing fills a hollow only up to its lowest rim: without its slope, the rim is the same all round. The slope is
  // taken from the opening, or a lamp would make a hollow of its own beside it, and from a quarter of the cells: it is
  // smooth.
  reduce({wide_.width, wide_.height, wide_opened_.cells}, 2, coarse_);
  average(coarse_, half_radius, coarse_mean_, sums_, per_cell_);
  enlarge(coarse_mean_, wide_.width, wide_.height, mean_);
  flatten(capped_.cells.data(), mean_.cells.data(), count);
  dilate_within(capped_, half_radius, filled_);
  erode_within(filled_, half_radius, closed_);
  for (int y = 0; y < closed_.height; ++y) {
    unflatten(closed_.row(y), mean_.row(y + margin) + margin, closed_.width);
  }
  enlarge(closed_, image.width, image.height, closed_full_);
  sink_below(closed_full_, *clean, dark_);

  // Not of single cells: the peak is to be that of something as wide as a fixture.
  saturating_difference(closed_, half_, peak_);
  erode(peak_, 1, broad_, scratch_);
  deepest_ = largest_of(broad_.cells.data(), broad_.cells.size());
  half_radius_ = half_radius;
  has_dark_peak_ = false;
}

const Raster& ContrastMap::dark_peak() {
  if (!has_dark_peak_) {
    dilate(broad_, half_radius_ / 2 + 1, peak_, scratch_);
    enlarge(peak_, dark_.width, dark_.height, dark_peak_);
    has_dark_peak_ = true;
  }
  return dark_peak_;
}

}  // namespace luminav
