#include "services/detector/row_bits.hpp"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace luminav {
namespace {

using Word = std::uint64_t;

/// Of up to 64 pixels.
Word word_plain(const std::uint8_t* pixels, int count, int above, int not_above) {
  Word bits = 0;
  for (int i = 0; i < count; ++i) {
    const Word in = pixels[i] > above || pixels[i] <= not_above ? 1 : 0;
    bits |= in << i;
  }
  return bits;
}

void take_plain(const std::uint8_t* pixels, int width, int rows, int above, int not_above, Word* out,
                std::size_t apart) {
  for (int y = 0; y < rows; ++y, pixels += width, out += apart) {
    for (int x = 0; x < width; x += 64) {
      out[x / 64] = word_plain(pixels + x, std::min(64, width - x), above, not_above);
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void take_avx2(const std::uint8_t* pixels, int width, int rows, int above,
                                               int not_above, Word* out, std::size_t apart) {
  // Saturating arithmetic makes an unsigned comparison: p - above > 0, and not_above - p >= 0 as min(p, low) = p.
  const __m256i high = _mm256_set1_epi8(static_cast<char>(std::clamp(above, 0, 255)));
  const __m256i low = _mm256_set1_epi8(static_cast<char>(std::clamp(not_above, 0, 255)));
  const __m256i no_low = _mm256_set1_epi8(static_cast<char>(not_above < 0 ? 0 : -1));
  const __m256i zero = _mm256_setzero_si256();
  const auto bits_of = [&](const std::uint8_t* p) __attribute__((target("avx2"))) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    const __m256i not_bright = _mm256_cmpeq_epi8(_mm256_subs_epu8(v, high), zero);
    const __m256i dark = _mm256_and_si256(_mm256_cmpeq_epi8(_mm256_min_epu8(v, low), v), no_low);
    return static_cast<Word>(~static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_andnot_si256(dark, not_bright))));
  };
  for (int y = 0; y < rows; ++y, pixels += width, out += apart) {
    int x = 0;
    for (; x + 64 <= width; x += 64) {
      out[x / 64] = bits_of(pixels + x) | bits_of(pixels + x + 32) << 32;
    }
    if (x + 32 <= width) {  // a row of a reduced image ends like that
      out[x / 64] = bits_of(pixels + x) | word_plain(pixels + x + 32, width - x - 32, above, not_above) << 32;
    } else if (x < width) {
      out[x / 64] = word_plain(pixels + x, width - x, above, not_above);
    }
  }
}
#endif

using TakeRowBits = void (*)(const std::uint8_t*, int, int, int, int, Word*, std::size_t);

TakeRowBits fastest_take() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return take_avx2;
  }
#endif
  return take_plain;
}

}  // namespace

void take_row_bits(const std::uint8_t* pixels, int width, int rows, int above, int not_above, std::uint64_t* bits,
                   std::size_t apart) {
  static const TakeRowBits take = fastest_take();
  take(pixels, width, rows, above, not_above, bits, apart);
}

}  // namespace luminav
