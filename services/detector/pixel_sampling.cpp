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

void sample_plain_below(const GreyView& image, const float* x, const float* y, const float* limit, std::size_t count,
                        float* grey) {
  for (std::size_t i = 0; i < count; ++i) {
    grey[i] = bilinear_below(image, x[i], y[i], limit[i]);
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

__attribute__((target("avx2"))) void sample_avx2_below(const GreyView& image, const float* x, const float* y,
                                                       const float* limit, std::size_t count, float* grey) {
  const PixelGather pixels(image);
  for (std::size_t i = 0; i < count; i += 8) {
    _mm256_storeu_ps(grey + i,
                     pixels.bilinear_below(_mm256_loadu_ps(x + i), _mm256_loadu_ps(y + i), _mm256_loadu_ps(limit + i)));
  }
}
#endif

struct Samplers {
  void (*sample)(const GreyView&, const float*, const float*, std::size_t, float*) = sample_plain;
  void (*sample_below)(const GreyView&, const float*, const float*, const float*, std::size_t,
                       float*) = sample_plain_below;
};

Samplers fastest_samplers() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return {sample_avx2, sample_avx2_below};
  }
#endif
  return {};
}

const Samplers& samplers() {
  static const Samplers fastest = fastest_samplers();
  return fastest;
}

}  // namespace

void bilinear_at(const GreyView& image, const float* x, const float* y, std::size_t count, float* grey) {
  samplers().sample(image, x, y, count, grey);
}

void bilinear_below_at(const GreyView& image, const float* x, const float* y, const float* limit, std::size_t count,
                       float* grey) {
  samplers().sample_below(image, x, y, limit, count, grey);
}

}  // namespace luminav
