#include "services/detector/profile_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"

#if defined(__x86_64__)
#include "services/detector/pixel_sampling_avx2.hpp"
#endif

namespace luminav {
namespace {

constexpr int kLanes = ProfileLanes::kLanes;
using Lanes = ProfileLanes::Lanes;
using Lines = ProfileLanes::Lines;

void add_plain(const GreyView& image, const Lines& lines, int length, Lanes* grey) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    float x = lines.x[lane];
    float y = lines.y[lane];
    float here = 0.0F;
    for (int k = 0; k < length; ++k) {
      if (k <= lines.last[lane]) {
        here = bilinear(image, x, y);
        x += lines.dx[lane];
        y += lines.dy[lane];
      }
      grey[k][lane] += here;
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void add_avx2(const GreyView& image, const Lines& lines, int length, Lanes* grey) {
  __m256 x = _mm256_loadu_ps(lines.x.data());
  __m256 y = _mm256_loadu_ps(lines.y.data());
  const __m256 dx = _mm256_loadu_ps(lines.dx.data());
  const __m256 dy = _mm256_loadu_ps(lines.dy.data());
  const __m256i last = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(lines.last.data()));
  const PixelGather pixels(image);
  for (int k = 0; k < length; ++k) {
    const __m256 here = pixels.bilinear(x, y);
    _mm256_storeu_ps(grey[k].data(), _mm256_add_ps(_mm256_loadu_ps(grey[k].data()), here));
    const __m256 on = _mm256_castsi256_ps(_mm256_cmpgt_epi32(last, _mm256_set1_epi32(k)));
    x = _mm256_add_ps(x, _mm256_and_ps(on, dx));
    y = _mm256_add_ps(y, _mm256_and_ps(on, dy));
  }
}
#endif

using AddLines = void (*)(const GreyView&, const Lines&, int, Lanes*);

AddLines fastest_add() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return add_avx2;
  }
#endif
  return add_plain;
}

/// One number of each lane, all of which one instruction works on, where the processor can. The compiler does not find
/// that in loops over the lanes.
using EachFloat [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using EachInt [[gnu::vector_size(kLanes * sizeof(int))]] = int;

LUMINAV_VECTOR_CLONES
void find_steps(const Lanes* grey, int length, int half_filter, float scale, ProfileLanes::Steps& steps) {
  std::array<EachFloat, ProfileLanes::kLongest + 1> sums;
  EachFloat sum{};
  sums[0] = sum;
  for (std::size_t k = 0; k < static_cast<std::size_t>(length); ++k) {
    EachFloat here;
    std::memcpy(&here, grey[k].data(), sizeof here);
    sum += here;
    sums[k + 1] = sum;
  }
  const auto h = static_cast<std::size_t>(half_filter);
  const int reach = length / 2;
  EachFloat best_score{};
  EachInt best = EachInt{} - 1;
  const int from = half_filter;
  const int to = length - half_filter;
  for (int k = from; k <= to; ++k) {
    const auto i = static_cast<std::size_t>(k);
    // of two edges of the same height, the nearer to the prediction
    const float nearness = 1.0F - 0.02F * std::abs(static_cast<float>(k - reach) - 0.5F);
    const EachFloat score = scale * (2.0F * sums[i] - sums[i - h] - sums[i + h]) * nearness;
    const EachInt better = score > best_score;
    best_score = better ? score : best_score;
    best = better ? EachInt{} + k : best;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const int at = best[lane];
    steps.at[lane] = at <= from || at >= to ? -1 : at;
    if (steps.at[lane] >= 0) {
      const auto i = static_cast<std::size_t>(at);
      const auto response = [&](std::size_t j) {
        return scale * (2.0F * sums[j][lane] - sums[j - h][lane] - sums[j + h][lane]);
      };
      steps.before[lane] = response(i - 1);
      steps.height[lane] = response(i);
      steps.behind[lane] = response(i + 1);
    }
  }
}

}  // namespace

void ProfileLanes::clear(int length) {
  length_ = length;
  std::fill_n(grey_.begin(), length, Lanes{});
}

void ProfileLanes::add(const GreyView& image, const Lines& lines) {
  static const AddLines add_lines = fastest_add();
  add_lines(image, lines, length_, grey_.data());
}

ProfileLanes::Steps ProfileLanes::largest_steps(int half_filter, float weight) const {
  Steps steps;
  find_steps(grey_.data(), length_, half_filter, weight / static_cast<float>(half_filter), steps);
  return steps;
}

void ProfileLanes::copy_lane(std::size_t lane, float* profile) const {
  for (int k = 0; k < length_; ++k) {
    profile[k] = grey_[static_cast<std::size_t>(k)][lane];
  }
}

}  // namespace luminav
