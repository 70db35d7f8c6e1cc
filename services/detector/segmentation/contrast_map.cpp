#include "services/detector/segmentation/contrast_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/sampling/grey_histogram.hpp"

namespace luminav {
namespace {

constexpr int kCap = 6;          // [grey] by which the ceiling may rise above its own opening (tiles, their grid)
constexpr int kFlatLevel = 128;  // [grey] of a flattened image

std::uint8_t clamped(int grey) {
  return static_cast<std::uint8_t>(std::clamp(grey, 0, 255));
}

/// Continues the image beyond its borders point-symmetrically, so that a slope stays a slope there. Without it the
/// surroundings of a border cell would all lie on one side, and shading alone would give it contrast.
void continue_beyond(const Raster& image, int margin, Raster& result) {
  result.resize(image.width + 2 * margin, image.height + 2 * margin);
  const int last = image.width - 1;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* in = image.row(y);
    std::uint8_t* out = result.row(y + margin) + margin;
    std::copy_n(in, image.width, out);
    for (int i = 1; i <= margin; ++i) {
      const int mirrored = std::min(i, last);
      out[-i] = clamped(2 * in[0] - in[mirrored]);
      out[last + i] = clamped(2 * in[last] - in[last - mirrored]);
    }
  }
  const int bottom = image.height - 1;
  for (int i = 1; i <= margin; ++i) {
    const int mirrored = std::min(i, bottom);
    for (int x = 0; x < result.width; ++x) {
      result.row(margin - i)[x] = clamped(2 * result.row(margin)[x] - result.row(margin + mirrored)[x]);
      result.row(margin + bottom + i)[x] =
          clamped(2 * result.row(margin + bottom)[x] - result.row(margin + bottom - mirrored)[x]);
    }
  }
}

LUMINAV_VECTOR_CLONES
void add_row(const std::uint8_t* enters, const std::uint8_t* leaves, int width, int* sums) {
#pragma GCC ivdep
  for (int x = 0; x < width; ++x) {
    sums[x] += enters[x] - leaves[x];
  }
}

/// Means over 2 radius + 1 cells in x and y; at the border its own cells are repeated.
void average(const Raster& image, int radius, Raster& result, std::vector<int>& sums) {
  const int width = image.width;
  const int last = image.height - 1;
  const int window = 2 * radius + 1;
  const float share = 1.0F / static_cast<float>(window * window);
  result.resize(width, image.height);
  sums.assign(static_cast<std::size_t>(width + window), 0);
  int* columns = sums.data() + radius;
  const std::vector<std::uint8_t>& nothing = result.cells;
  std::fill_n(result.cells.begin(), width, std::uint8_t{0});
  for (int dy = -radius; dy <= radius; ++dy) {
    add_row(image.row(std::clamp(dy, 0, last)), nothing.data(), width, columns);
  }
  for (int y = 0; y <= last; ++y) {
    std::fill_n(sums.begin(), radius, columns[0]);
    std::fill_n(columns + width, radius + 1, columns[width - 1]);
    int sum = std::accumulate(sums.begin(), sums.begin() + window, 0);
    std::uint8_t* out = result.row(y);
    for (int x = 0; x < width; ++x) {
      out[x] = static_cast<std::uint8_t>(share * static_cast<float>(sum) + 0.5F);
      sum += columns[x + radius + 1] - columns[x - radius];
    }
    add_row(image.row(std::min(y + radius + 1, last)), image.row(std::max(y - radius, 0)), width, columns);
  }
}

/// What of the image is no lamp, without the slope of the light.
LUMINAV_VECTOR_CLONES
void flatten(const std::uint8_t* image, const std::uint8_t* opened, const std::uint8_t* mean, std::size_t count,
             std::uint8_t* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const int capped = std::min<int>(image[i], opened[i] + kCap);
    out[i] = static_cast<std::uint8_t>(std::clamp(kFlatLevel + capped - mean[i], 0, 255));
  }
}

LUMINAV_VECTOR_CLONES
void unflatten(std::uint8_t* image, const std::uint8_t* mean, int count) {
#pragma GCC ivdep
  for (int i = 0; i < count; ++i) {
    image[i] = static_cast<std::uint8_t>(std::clamp(image[i] + mean[i] - kFlatLevel, 0, 255));
  }
}

/// Means of 3 x 3 cells; at both ends, of three.
LUMINAV_VECTOR_CLONES
void smooth_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int width,
                std::uint8_t* out) {
#pragma GCC ivdep
  for (int x = 1; x < width - 1; ++x) {
    const int sum = above[x - 1] + above[x] + above[x + 1] + here[x - 1] + here[x] + here[x + 1] + below[x - 1] +
                    below[x] + below[x + 1] + 4;
    out[x] = static_cast<std::uint8_t>((sum * 7282) >> 16);  // 7282 / 65536 = 1 / 9
  }
  for (const int x : {0, width - 1}) {
    out[x] = static_cast<std::uint8_t>((above[x] + here[x] + below[x] + 1) / 3);
  }
}

void smooth(const Raster& image, Raster& result) {
  result.resize(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    smooth_row(image.row(std::max(y - 1, 0)), image.row(y), image.row(std::min(y + 1, image.height - 1)), image.width,
               result.row(y));
  }
}

/// By how much each cell stays below its level.
LUMINAV_VECTOR_CLONES
void sink(const std::uint8_t* level, std::span<std::uint8_t> cells) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] = static_cast<std::uint8_t>(std::max(level[i] - cells[i], 0));
  }
}

LUMINAV_VECTOR_CLONES
void double_cells(const std::uint8_t* cells, int count, std::uint8_t* out) {
#pragma GCC ivdep
  for (int x = 0; x < count; ++x) {
    out[2 * x] = cells[x];
    out[2 * x + 1] = cells[x];
  }
}

/// Below what is known at half the size.
void sink_below(const Raster& half, const Raster& image, std::vector<std::uint8_t>& level, Raster& result) {
  smooth(image, result);
  level.resize(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* coarse = half.row(std::min(y / 2, half.height - 1));
    double_cells(coarse, half.width, level.data());
    level.back() = coarse[half.width - 1];  // of an odd width
    sink(level.data(), {result.row(y), level.size()});
  }
}

}  // namespace

double ContrastMap::noise_of(const Raster& image) {
  constexpr double kMinNoise = 0.3;
  constexpr std::size_t kSamples = 4096;
  steps_.clear();
  for (int y = 3; y < image.height; y += 7) {
    const std::uint8_t* row = image.row(y);
    for (int x = 0; x + 1 < image.width; ++x) {
      steps_.push_back(static_cast<std::uint8_t>(std::abs(row[x] - row[x + 1])));
    }
  }
  // median of |a - b| = 0.954 sigma of one
  return std::max(kMinNoise, GreyHistogram(steps_, 1 + steps_.size() / kSamples).interpolated_median() / 0.954);
}

void ContrastMap::compute(const Raster& image, int radius, bool ignore_lines) {
  const Raster* clean = &image;
  if (ignore_lines) {
    dilate(image, 1, dilated_, scratch_);
    erode(dilated_, 1, clean_, scratch_);
    clean = &clean_;
  }
  reduce({clean->width, clean->height, clean->cells}, 2, half_);
  const int half_radius = std::max(1, (radius + 1) / 2);
  const int margin = 2 * half_radius;
  continue_beyond(half_, margin, wide_);
  erode(wide_, half_radius, filled_, scratch_);
  dilate(filled_, half_radius, opened_, scratch_);
  // A closing fills a hollow only up to its lowest rim: without its slope, the rim is the same all round. The slope is
  // taken from the opening, or a lamp would make a hollow of its own beside it.
  average(opened_, half_radius, mean_, sums_);
  flatten(wide_.cells.data(), opened_.cells.data(), mean_.cells.data(), wide_.cells.size(), wide_.cells.data());
  dilate_within(wide_, half_radius, filled_);
  erode_within(filled_, half_radius, closed_);
  for (int y = 0; y < closed_.height; ++y) {
    unflatten(closed_.row(y), mean_.row(y + margin) + margin, closed_.width);
  }
  sink_below(closed_, *clean, level_, dark_);
}

void ContrastMap::compute_narrow(const Raster& image, int radius, bool is_noisy) {
  if (is_noisy) {
    smooth(image, dark_);
  } else {
    dark_ = image;
  }
  dilate(dark_, radius, dilated_, scratch_);
  erode(dilated_, radius, filled_, scratch_);
  sink(filled_.cells.data(), dark_.cells);
}

}  // namespace luminav
