#pragma once

#include <immintrin.h>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// `bilinear` at eight places; for functions compiled for AVX2 only.
class PixelGather {
 public:
  // Four bytes are read for two pixels: in the upper row those behind, in the lower row those before, never beyond the
  // image.
  __attribute__((target("avx2"))) explicit PixelGather(const GreyView& image)
      : upper_(reinterpret_cast<const int*>(image.pixels.data())),
        lower_(reinterpret_cast<const int*>(image.pixels.data() + image.width - 2)),
        width_(_mm256_set1_epi32(image.width)) {}

  __attribute__((target("avx2"), always_inline)) inline __m256 bilinear(__m256 x, __m256 y) const {
    const Neighbours at = neighbours(x, y);
    const __m256 top = _mm256_add_ps(_mm256_cvtepi32_ps(at.p0),
                                     _mm256_mul_ps(at.fx, _mm256_cvtepi32_ps(_mm256_sub_epi32(at.p1, at.p0))));
    const __m256 bottom = _mm256_add_ps(_mm256_cvtepi32_ps(at.q0),
                                        _mm256_mul_ps(at.fx, _mm256_cvtepi32_ps(_mm256_sub_epi32(at.q1, at.q0))));
    return _mm256_add_ps(top, _mm256_mul_ps(at.fy, _mm256_sub_ps(bottom, top)));
  }

  __attribute__((target("avx2"), always_inline)) inline __m256 bilinear_below(__m256 x, __m256 y, __m256 limit) const {
    const Neighbours at = neighbours(x, y);
    const __m256 p0 = _mm256_min_ps(_mm256_cvtepi32_ps(at.p0), limit);
    const __m256 p1 = _mm256_min_ps(_mm256_cvtepi32_ps(at.p1), limit);
    const __m256 q0 = _mm256_min_ps(_mm256_cvtepi32_ps(at.q0), limit);
    const __m256 q1 = _mm256_min_ps(_mm256_cvtepi32_ps(at.q1), limit);
    const __m256 top = _mm256_add_ps(p0, _mm256_mul_ps(at.fx, _mm256_sub_ps(p1, p0)));
    const __m256 bottom = _mm256_add_ps(q0, _mm256_mul_ps(at.fx, _mm256_sub_ps(q1, q0)));
    return _mm256_add_ps(top, _mm256_mul_ps(at.fy, _mm256_sub_ps(bottom, top)));
  }

 private:
  struct Neighbours {
    __m256i p0, p1, q0, q1;  // grey levels: upper left, upper right, lower left, lower right
    __m256 fx, fy;           // shares of the right, of the lower ones
  };

  __attribute__((target("avx2"), always_inline)) inline Neighbours neighbours(__m256 x, __m256 y) const {
    const __m256i byte = _mm256_set1_epi32(0xFF);
    const __m256i column = _mm256_cvttps_epi32(x);
    const __m256i row = _mm256_cvttps_epi32(y);
    const __m256i offset = _mm256_add_epi32(_mm256_mullo_epi32(row, width_), column);
    const __m256i p = _mm256_i32gather_epi32(upper_, offset, 1);
    const __m256i q = _mm256_i32gather_epi32(lower_, offset, 1);
    return {_mm256_and_si256(p, byte),
            _mm256_and_si256(_mm256_srli_epi32(p, 8), byte),
            _mm256_and_si256(_mm256_srli_epi32(q, 16), byte),
            _mm256_srli_epi32(q, 24),
            _mm256_sub_ps(x, _mm256_cvtepi32_ps(column)),
            _mm256_sub_ps(y, _mm256_cvtepi32_ps(row))};
  }

  const int* upper_;
  const int* lower_;
  __m256i width_;
};

}  // namespace luminav
