#include "services/detector/pixel_sampling.hpp"

#if defined(__x86_64__)
#include "services/detector/pixel_sampling_avx2.hpp"
#endif

namespace luminav {
namespace {

void sample_plain(const GreyView& image, const float* x, const float* y, std::size_t count, float* grey) {
  for (std::size_t i = 0; i < count; ++i) {
    grey[i] = bilinear(image, x[i], y[i]);
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void sample_avx2(const GreyView& image, const float* x, const float* y,
                                                 std::size_t count, float* grey) {
  const PixelGather pixels(image);
  for (std::size_t i = 0; i < count; i += 8) {
    _mm256_storeu_ps(grey + i, pixels.bilinear(_mm256_loadu_ps(x + i), _mm256_loadu_ps(y + i)));
  }
}
#endif

using Sample = void (*)(const GreyView&, const float*, const float*, std::size_t, float*);

Sample fastest_sample() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return sample_avx2;
  }
#endif
  return sample_plain;
}

}  // namespace

void bilinear_at(const GreyView& image, const float* x, const float* y, std::size_t count, float* grey) {
  static const Sample sample = fastest_sample();
  sample(image, x, y, count, grey);
}

}  // namespace luminav
