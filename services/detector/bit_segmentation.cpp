#include "services/detector/bit_segmentation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/row_bits.hpp"

namespace luminav {
namespace {

using Word = std::uint64_t;

/// a &= a shifted towards lower x by `shift` pixels; the array's last word is not written.
LUMINAV_VECTOR_CLONES
void and_shifted(Word* words, std::size_t count, int shift) {
  const int rest = 64 - shift;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    words[i] &= (words[i] >> shift) | (words[i + 1] << rest);
  }
}

LUMINAV_VECTOR_CLONES
void or_shifted(Word* words, std::size_t count, int shift) {
  const int rest = 64 - shift;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    words[i] |= (words[i] >> shift) | (words[i + 1] << rest);
  }
}

LUMINAV_VECTOR_CLONES
void and_rows(Word* words, std::size_t count, std::size_t offset) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    words[i] &= words[i + offset];
  }
}

LUMINAV_VECTOR_CLONES
void or_rows(Word* words, std::size_t count, std::size_t offset) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    words[i] |= words[i + offset];
  }
}

/// Combines each pixel with the 2 radius pixels (or rows) after it by windows of 1, 2, 4, ...
template <typename Step>
void combine_window(int radius, Step step) {
  const int window = 2 * radius + 1;
  int size = 1;
  for (; 2 * size <= window; size *= 2) {
    step(size);
  }
  if (window > size) {
    step(window - size);
  }
}

std::int64_t cross(const std::array<int, 2>& o, const std::array<int, 2>& a, const std::array<int, 2>& b) {
  return static_cast<std::int64_t>(a[0] - o[0]) * (b[1] - o[1]) -
         static_cast<std::int64_t>(a[1] - o[1]) * (b[0] - o[0]);
}

}  // namespace

/// The mask has `radius` rows above and below and one word left and right. Beyond the image everything counts as set
/// while eroding and as clear while dilating, as OpenCV has it. Windows reach to higher x and y; the result is taken
/// from where they are centred.
void BitSegmentation::open(int radius, int width) {
  const auto stride = static_cast<std::size_t>(words_);
  const auto pad = static_cast<std::size_t>(radius);
  const auto height = static_cast<std::size_t>(rows_) - 2 * pad;
  const std::size_t all = stride * static_cast<std::size_t>(rows_);
  const auto fill_outside = [&](std::vector<Word>& words, Word value) {
    std::fill_n(words.begin(), pad * stride, value);
    std::fill_n(words.begin() + static_cast<std::ptrdiff_t>((pad + height) * stride), pad * stride, value);
    const int last_bits = width % 64;
    const auto last = static_cast<std::size_t>((width + 63) / 64);  // word with the last pixels, after the left margin
    for (std::size_t y = pad; y < pad + height; ++y) {
      Word* row = words.data() + y * stride;
      row[0] = value;
      for (std::size_t w = last + 1; w < stride; ++w) {
        row[w] = value;
      }
      if (last_bits != 0) {
        const Word inside = (Word{1} << last_bits) - 1;
        row[last] = (row[last] & inside) | (value & ~inside);
      }
    }
  };
  for (const bool erode : {true, false}) {
    fill_outside(mask_, erode ? ~Word{0} : Word{0});
    combine_window(radius, [&](int shift) { (erode ? and_shifted : or_shifted)(mask_.data(), all - 1, shift); });
    // A window that begins at pixel p was centred at p + radius; the shift back is undone row by row.
    std::size_t rows = static_cast<std::size_t>(rows_);
    combine_window(radius, [&](int size) {
      rows -= static_cast<std::size_t>(size);
      (erode ? and_rows : or_rows)(mask_.data(), rows * stride, static_cast<std::size_t>(size) * stride);
    });
    for (std::size_t y = 0; y < height; ++y) {
      const Word* from = mask_.data() + y * stride;
      Word* to = work_.data() + (y + pad) * stride;
      for (std::size_t w = 1; w + 1 < stride; ++w) {
        to[w] = (from[w] << radius) | (from[w - 1] >> (64 - radius));
      }
    }
    mask_.swap(work_);
  }
  fill_outside(mask_, 0);
}

int BitSegmentation::root(int run) {
  while (runs_[static_cast<std::size_t>(run)].parent != run) {
    int& parent = runs_[static_cast<std::size_t>(run)].parent;
    parent = runs_[static_cast<std::size_t>(parent)].parent;
    run = parent;
  }
  return run;
}

void BitSegmentation::find_runs(int width, int height) {
  runs_.clear();
  const int pad = (rows_ - height) / 2;
  const auto stride = static_cast<std::size_t>(words_);
  int above = 0;
  int above_end = 0;
  for (int y = 0; y < height; ++y) {
    const Word* row = mask_.data() + static_cast<std::size_t>(y + pad) * stride + 1;
    const int begin = static_cast<int>(runs_.size());
    Word carry = 0;
    int first = -1;
    for (int w = 0; 64 * w < width; ++w) {
      Word changes = row[w] ^ ((row[w] << 1) | carry);
      carry = row[w] >> 63;
      while (changes != 0) {
        const int x = 64 * w + std::countr_zero(changes);
        changes &= changes - 1;
        if (first < 0) {
          first = x;
        } else {
          const int index = static_cast<int>(runs_.size());
          runs_.push_back({y, first, x - 1, index, -1});
          first = -1;
        }
      }
    }
    if (first >= 0) {
      const int index = static_cast<int>(runs_.size());
      runs_.push_back({y, first, width - 1, index, -1});
    }
    const int end = static_cast<int>(runs_.size());
    for (int current = begin; current < end; ++current) {
      const int from = runs_[static_cast<std::size_t>(current)].first - 1;
      const int to = runs_[static_cast<std::size_t>(current)].last + 1;
      while (above < above_end && runs_[static_cast<std::size_t>(above)].last < from) {
        ++above;
      }
      for (int other = above; other < above_end && runs_[static_cast<std::size_t>(other)].first <= to; ++other) {
        const int a = root(other);
        const int b = root(current);
        runs_[static_cast<std::size_t>(std::max(a, b))].parent = std::min(a, b);
      }
    }
    above = begin;
    above_end = end;
  }
}

void BitSegmentation::collect(int least_pixels) {
  sums_.assign(runs_.size(), Sums{});
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    const int top = root(i);
    const BitRun& run = runs_[static_cast<std::size_t>(i)];
    Sums& sums = sums_[static_cast<std::size_t>(top)];
    if (sums.count == 0) {
      sums.head = i;
    } else {
      runs_[static_cast<std::size_t>(sums.tail)].next = i;
    }
    sums.tail = i;
    const std::int64_t n = run.last - run.first + 1;
    const std::int64_t a = run.first;
    const std::int64_t b = run.last;
    const std::int64_t x = (a + b) * n / 2;
    // sum of squares 0..k = k (k + 1) (2k + 1) / 6
    const std::int64_t xx = (b * (b + 1) * (2 * b + 1) - (a - 1) * a * (2 * a - 1)) / 6;
    sums.count += n;
    sums.x += x;
    sums.xx += xx;
    sums.y += n * run.row;
    sums.yy += n * run.row * run.row;
    sums.xy += x * run.row;
  }
  blobs_.clear();
  for (const Sums& sums : sums_) {
    if (sums.count >= std::max(least_pixels, 1)) {
      Blob blob;
      measure(sums, blob);
      blobs_.push_back(blob);
    }
  }
}

void BitSegmentation::measure(const Sums& sums, Blob& blob) {
  const auto n = static_cast<double>(sums.count);
  blob.pixels = static_cast<int>(sums.count);
  blob.x = static_cast<double>(sums.x) / n;
  blob.y = static_cast<double>(sums.y) / n;
  const double xx = static_cast<double>(sums.xx) / n - blob.x * blob.x;
  const double yy = static_cast<double>(sums.yy) / n - blob.y * blob.y;
  const double xy = static_cast<double>(sums.xy) / n - blob.x * blob.y;
  blob.theta = 0.5 * std::atan2(2.0 * xy, xx - yy);

  // Hull of the runs' ends: per row the leftmost and the rightmost, a chain for each side.
  left_.clear();
  right_.clear();
  for (int i = sums.head; i >= 0; i = runs_[static_cast<std::size_t>(i)].next) {
    const BitRun& run = runs_[static_cast<std::size_t>(i)];
    if (!left_.empty() && left_.back()[1] == run.row) {
      right_.back()[0] = run.last;
      continue;
    }
    left_.push_back({run.first, run.row});
    right_.push_back({run.last, run.row});
  }
  hull_.clear();
  const auto chain = [&](const std::array<int, 2>& point, std::size_t start) {
    while (hull_.size() >= start + 2 && cross(hull_[hull_.size() - 2], hull_.back(), point) <= 0) {
      hull_.pop_back();
    }
    hull_.push_back(point);
  };
  for (const auto& point : right_) {
    chain(point, 0);
  }
  const std::size_t start = hull_.size();
  for (auto point = left_.rbegin(); point != left_.rend(); ++point) {
    chain(*point, start);
  }
  smallest_rectangle(blob);
}

/// One side of the smallest rectangle lies on an edge of the hull (Freeman and Shapira 1975); hulls here have some
/// twenty corners, so trying each edge against each corner costs less than keeping calipers.
void BitSegmentation::smallest_rectangle(Blob& blob) const {
  double smallest = 1e300;
  const std::size_t count = hull_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto& a = hull_[i];
    const auto& b = hull_[(i + 1) % count];
    const double dx = b[0] - a[0];
    const double dy = b[1] - a[1];
    const double norm = std::sqrt(dx * dx + dy * dy);
    if (norm == 0.0) {
      continue;
    }
    const double ux = dx / norm;
    const double uy = dy / norm;
    double least_u = 1e300;
    double most_u = -1e300;
    double least_v = 1e300;
    double most_v = -1e300;
    for (const auto& point : hull_) {
      const double u = ux * point[0] + uy * point[1];
      const double v = ux * point[1] - uy * point[0];
      least_u = std::min(least_u, u);
      most_u = std::max(most_u, u);
      least_v = std::min(least_v, v);
      most_v = std::max(most_v, v);
    }
    const double extent_u = most_u - least_u;
    const double extent_v = most_v - least_v;
    if (extent_u * extent_v < smallest) {
      smallest = extent_u * extent_v;
      blob.length = std::max(extent_u, extent_v);
      blob.width = std::min(extent_u, extent_v);
      blob.rectangle_theta = extent_u >= extent_v ? std::atan2(uy, ux) : std::atan2(ux, -uy);
      const auto corner = [&](double u, double v) { return std::array<double, 2>{ux * u - uy * v, uy * u + ux * v}; };
      blob.corners = {corner(least_u, least_v), corner(most_u, least_v), corner(most_u, most_v),
                      corner(least_u, most_v)};
    }
  }
  blob.rectangle_theta = std::remainder(blob.rectangle_theta, 3.14159265358979323846);
}

const std::vector<Blob>& BitSegmentation::find(const GreyView& image, const BitSegmentationParams& params) {
  const int radius = std::clamp(params.opening, 0, 15);
  words_ = (image.width + 63) / 64 + 2;
  rows_ = image.height + 2 * radius;
  const std::size_t all = static_cast<std::size_t>(words_) * static_cast<std::size_t>(rows_);
  mask_.resize(all);
  work_.resize(all);
  Word* first_row = mask_.data() + static_cast<std::size_t>(radius) * static_cast<std::size_t>(words_);
  for (int y = 0; y < image.height; ++y) {
    Word* row = first_row + static_cast<std::ptrdiff_t>(y) * words_;
    row[0] = 0;
    row[words_ - 1] = 0;
  }
  take_row_bits(image.pixels.data(), image.width, image.height, params.above, params.not_above, first_row + 1,
                static_cast<std::size_t>(words_));
  if (radius > 0) {
    open(radius, image.width);
  }
  find_runs(image.width, image.height);
  collect(params.least_pixels);
  return blobs_;
}

}  // namespace luminav
