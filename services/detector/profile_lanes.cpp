#include "services/detector/profile_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

LUMINAV_VECTOR_CLONES
void find_steps(const Lanes* grey, int length, int half_filter, float scale, ProfileLanes::Steps& steps) {
  constexpr int kLongest = ProfileLanes::kLongest;
  alignas(32) std::array<std::array<float, kLanes>, kLongest + 1> sums;
  sums[0].fill(0.0F);
  for (int k = 0; k < length; ++k) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sums[static_cast<std::size_t>(k) + 1][lane] = sums[static_cast<std::size_t>(k)][lane] + grey[k][lane];
    }
  }
  const auto h = static_cast<std::size_t>(half_filter);
  const auto response = [&](std::size_t i, std::size_t lane) {
    return scale * (2.0F * sums[i][lane] - sums[i - h][lane] - sums[i + h][lane]);
  };
  const int reach = length / 2;
  alignas(32) Lanes best_score{};
  alignas(32) std::array<int, kLanes> best;
  best.fill(-1);
  const int from = half_filter;
  const int to = length - half_filter;
  for (int k = from; k <= to; ++k) {
    const auto i = static_cast<std::size_t>(k);
    // of two edges of the same height, the nearer to the prediction
    const float nearness = 1.0F - 0.02F * std::abs(static_cast<float>(k - reach) - 0.5F);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float score = scale * (2.0F * sums[i][lane] - sums[i - h][lane] - sums[i + h][lane]) * nearness;
      const bool better = score > best_score[lane];
      best_score[lane] = better ? score : best_score[lane];
      best[lane] = better ? k : best[lane];
    }
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    steps.at[lane] = best[lane] <= from || best[lane] >= to ? -1 : best[lane];
    if (steps.at[lane] >= 0) {
      const auto i = static_cast<std::size_t>(best[lane]);
      steps.before[lane] = response(i - 1, lane);
      steps.height[lane] = response(i, lane);
      steps.behind[lane] = response(i + 1, lane);
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
