#include "services/detector/contrast_map.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace luminav {
namespace {

constexpr int kCap = 6;  // [grey] by which the ceiling may rise above its own opening (tiles, their joints)

/// Twice the size in x and y by linear interpolation between cell centres; nothing is invented beyond the border.
void enlarge(const Raster& half, int width, int height, Raster& result) {
  result.resize(width, height);
  for (int y = 0; y < height; ++y) {
    const int near_row = std::min(y / 2, half.height - 1);
    const int far_row = std::clamp(y % 2 == 0 ? near_row - 1 : near_row + 1, 0, half.height - 1);
    const std::uint8_t* a = half.row(near_row);
    const std::uint8_t* b = half.row(far_row);
    std::uint8_t* out = result.row(y);
    const auto blend = [&](int near_cell, int far_cell) {
      const int at_near = 3 * a[near_cell] + b[near_cell];
      const int at_far = 3 * a[far_cell] + b[far_cell];
      return static_cast<std::uint8_t>((3 * at_near + at_far + 8) >> 4);
    };
    out[0] = blend(0, 0);
    const int pairs = std::min((width - 1) / 2, half.width - 1);
    for (int i = 0; i < pairs; ++i) {
      const int left = 3 * a[i] + b[i];
      const int right = 3 * a[i + 1] + b[i + 1];
      out[2 * i + 1] = static_cast<std::uint8_t>((3 * left + right + 8) >> 4);
      out[2 * i + 2] = static_cast<std::uint8_t>((left + 3 * right + 8) >> 4);
    }
    for (int x = 2 * pairs + 1; x < width; ++x) {
      out[x] = blend(half.width - 1, half.width - 1);
    }
  }
}

/// Continues the image beyond its borders point-symmetrically, so that a slope stays a slope there. Without it the
/// surroundings of a border cell would all lie on one side, and shading alone would give it contrast.
void continue_beyond(const Raster& image, int margin, Raster& result) {
  result.resize(image.width + 2 * margin, image.height + 2 * margin);
  const auto continued = [](int edge, int mirrored) {
    return static_cast<std::uint8_t>(std::clamp(2 * edge - mirrored, 0, 255));
  };
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* in = image.row(y);
    std::uint8_t* out = result.row(y + margin) + margin;
    std::copy_n(in, image.width, out);
    const int last = image.width - 1;
    for (int i = 1; i <= margin; ++i) {
      out[-i] = continued(in[0], in[std::min(i, last)]);
      out[last + i] = continued(in[last], in[std::max(last - i, 0)]);
    }
  }
  const int last = image.height - 1;
  for (int i = 1; i <= margin; ++i) {
    const std::uint8_t* top = result.row(margin);
    const std::uint8_t* below = result.row(margin + std::min(i, last));
    const std::uint8_t* bottom = result.row(margin + last);
    const std::uint8_t* above = result.row(margin + std::max(last - i, 0));
    std::uint8_t* over = result.row(margin - i);
    std::uint8_t* under = result.row(margin + last + i);
    for (int x = 0; x < result.width; ++x) {
      over[x] = continued(top[x], below[x]);
      under[x] = continued(bottom[x], above[x]);
    }
  }
}

/// Means over 2 radius + 1 cells in x and y; beyond the border the window is cut off on both sides alike, so that a
/// slope is its own mean everywhere.
void average(const Raster& image, int radius, Raster& result, std::vector<std::uint32_t>& sums) {
  const int width = image.width;
  const int height = image.height;
  const auto stride = static_cast<std::size_t>(width) + 1;
  sums.assign(stride * (static_cast<std::size_t>(height) + 1), 0);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* in = image.row(y);
    const std::uint32_t* above = sums.data() + static_cast<std::size_t>(y) * stride;
    std::uint32_t* below = sums.data() + static_cast<std::size_t>(y + 1) * stride;
    std::uint32_t row_sum = 0;
    for (int x = 0; x < width; ++x) {
      row_sum += in[x];
      below[x + 1] = above[x + 1] + row_sum;
    }
  }
  result.resize(width, height);
  for (int y = 0; y < height; ++y) {
    const int ry = std::min({radius, y, height - 1 - y});
    const std::uint32_t* top = sums.data() + static_cast<std::size_t>(y - ry) * stride;
    const std::uint32_t* bottom = sums.data() + static_cast<std::size_t>(y + ry + 1) * stride;
    std::uint8_t* out = result.row(y);
    for (int x = 0; x < width; ++x) {
      const int rx = std::min({radius, x, width - 1 - x});
      const std::uint32_t sum = bottom[x + rx + 1] - bottom[x - rx] - top[x + rx + 1] + top[x - rx];
      const auto area = static_cast<std::uint32_t>((2 * rx + 1) * (2 * ry + 1));
      out[x] = static_cast<std::uint8_t>((sum + area / 2) / area);
    }
  }
}

constexpr int kFlatLevel = 128;  // [grey] of a flattened image

void flatten(Raster& image, const Raster& mean) {
  for (std::size_t i = 0; i < image.cells.size(); ++i) {
    image.cells[i] = static_cast<std::uint8_t>(std::clamp(kFlatLevel + image.cells[i] - mean.cells[i], 0, 255));
  }
}

void unflatten(Raster& image, const Raster& mean) {
  for (std::size_t i = 0; i < image.cells.size(); ++i) {
    image.cells[i] = static_cast<std::uint8_t>(std::clamp(image.cells[i] + mean.cells[i] - kFlatLevel, 0, 255));
  }
}

void cut_margin(const Raster& image, int margin, Raster& result) {
  result.resize(image.width - 2 * margin, image.height - 2 * margin);
  for (int y = 0; y < result.height; ++y) {
    std::copy_n(image.row(y + margin) + margin, result.width, result.row(y));
  }
}

void saturating_difference(const Raster& minuend, const Raster& subtrahend, Raster& result) {
  result.resize(minuend.width, minuend.height);
  const std::uint8_t* a = minuend.cells.data();
  const std::uint8_t* b = subtrahend.cells.data();
  std::uint8_t* out = result.cells.data();
  const std::size_t count = result.cells.size();
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = static_cast<std::uint8_t>(a[i] > b[i] ? a[i] - b[i] : 0);
  }
}

void cap(const Raster& image, const Raster& level, Raster& result) {
  result.resize(image.width, image.height);
  const std::size_t count = result.cells.size();
  for (std::size_t i = 0; i < count; ++i) {
    result.cells[i] = static_cast<std::uint8_t>(std::min<int>(image.cells[i], std::min(level.cells[i] + kCap, 255)));
  }
}

/// Means of 3 x 3 cells, the border repeated.
void smooth(const Raster& image, Raster& result) {
  result.resize(image.width, image.height);
  std::array<std::uint16_t, 8192> sums;
  const int last = std::min(image.width, 8192) - 1;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* above = image.row(std::max(y - 1, 0));
    const std::uint8_t* here = image.row(y);
    const std::uint8_t* below = image.row(std::min(y + 1, image.height - 1));
    for (int x = 0; x <= last; ++x) {
      sums[static_cast<std::size_t>(x)] = static_cast<std::uint16_t>(above[x] + here[x] + below[x]);
    }
    std::uint8_t* out = result.row(y);
    const std::uint16_t* s = sums.data();
    for (int x = 1; x < last; ++x) {
      // 7282 / 65536 = 1 / 9
      out[x] = static_cast<std::uint8_t>((static_cast<unsigned>(s[x - 1] + s[x] + s[x + 1] + 4) * 7282U) >> 16);
    }
    out[0] = static_cast<std::uint8_t>((2 * s[0] + s[1] + 4) / 9);
    out[last] = static_cast<std::uint8_t>((2 * s[last] + s[last - 1] + 4) / 9);
  }
}

/// Median absolute difference of horizontal neighbours, over every seventh row, as a standard deviation.
double noise_of(const Raster& image) {
  std::array<int, 256> histogram{};
  int count = 0;
  for (int y = 3; y < image.height; y += 7) {
    const std::uint8_t* row = image.row(y);
    for (int x = 1; x < image.width; ++x) {
      ++histogram[static_cast<std::size_t>(std::abs(row[x] - row[x - 1]))];
      ++count;
    }
  }
  int below = 0;
  for (std::size_t level = 0; level < histogram.size(); ++level) {
    below += histogram[level];
    if (2 * below >= count) {
      // median of |a - b| = 0.954 sigma of one; linear within the grey level
      const double inside = (0.5 * count - (below - histogram[level])) / std::max(histogram[level], 1);
      return std::max(0.3, (static_cast<double>(level) - 0.5 + inside) / 0.954);
    }
  }
  return 0.3;
}

}  // namespace

void ContrastMap::compute(const Raster& image, int radius, bool ignore_lines) {
  noise_ = noise_of(image);
  const int half_radius = std::max(1, (radius + 1) / 2);
  const Raster* clean = &image;
  if (ignore_lines) {
    dilate(image, 1, smooth_, scratch_);
    erode(smooth_, 1, clean_, scratch_);
    clean = &clean_;
  }
  reduce({clean->width, clean->height, clean->cells}, 2, half_);
  const int margin = 2 * half_radius;
  continue_beyond(half_, margin, wide_);
  erode(wide_, half_radius, eroded_, scratch_);
  dilate(eroded_, half_radius, wide_opened_, scratch_);
  cap(wide_, wide_opened_, capped_);
  // A closing fills a hollow only up to its lowest rim: without its slope, the rim is the same all round.
  average(capped_, 2 * half_radius, mean_, sums_);
  flatten(capped_, mean_);
  dilate(capped_, half_radius, eroded_, scratch_);
  erode(eroded_, half_radius, closed_, scratch_);
  unflatten(closed_, mean_);
  cut_margin(wide_opened_, margin, opened_);
  cut_margin(closed_, margin, wide_);
  std::swap(wide_, closed_);
  enlarge(opened_, image.width, image.height, opened_full_);
  enlarge(closed_, image.width, image.height, closed_full_);
  saturating_difference(*clean, opened_full_, bright_);
  smooth(*clean, smooth_);
  saturating_difference(closed_full_, smooth_, dark_);

  saturating_difference(half_, opened_, eroded_);
  dilate(eroded_, half_radius / 2, peak_, scratch_);
  enlarge(peak_, image.width, image.height, bright_peak_);

  // Not of single cells: the peak is to be that of something as wide as a fixture.
  saturating_difference(closed_, half_, peak_);
  erode(peak_, 1, eroded_, scratch_);
  dilate(eroded_, half_radius / 2 + 1, peak_, scratch_);
  enlarge(peak_, image.width, image.height, dark_peak_);
}

}  // namespace luminav
