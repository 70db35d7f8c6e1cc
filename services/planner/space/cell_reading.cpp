#include "services/planner/space/cell_reading.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace luminav {
namespace {

constexpr int kWord = 64;  // cells a word
// [bytes] fetched ahead, two pages: over a grid that no cache holds each new page was waited for
constexpr int kAhead = 8192;

/// Eight bytes of 0 or 1 to eight bits: the product gathers them in its highest byte.
std::uint64_t pack(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, 8);
  return word * 0x0102040810204080ULL >> 56;
}

std::uint64_t pack_64(const std::array<std::uint8_t, kWord>& bytes) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    word |= pack(bytes.data() + 8 * i) << (8 * i);
  }
  return word;
}

void read_words_plain(const CellReading& reading, const Prior* prior, const std::int8_t* evidence, int words,
                      std::uint64_t* solid, std::uint64_t* unknown) {
  const int disputed_is_wall = reading.disputed_is_wall ? 1 : 0;
  const int unknown_blocks = reading.unknown_blocks ? 1 : 0;
  std::array<std::uint8_t, kWord> is_solid;
  std::array<std::uint8_t, kWord> is_unknown;
  for (int word = 0; word < words; ++word, prior += kWord, evidence += kWord) {
    for (std::size_t i = 0; i < kWord; ++i) {
      const int is_wall =
          (prior[i] == Prior::kOccupied ? 1 : 0) | ((prior[i] == Prior::kDisputed ? 1 : 0) & disputed_is_wall);
      is_solid[i] = static_cast<std::uint8_t>(is_wall | (evidence[i] > reading.occupied ? 1 : 0));
      is_unknown[i] = static_cast<std::uint8_t>((prior[i] == Prior::kUnknown ? 1 : 0) & unknown_blocks &
                                                (evidence[i] > reading.not_free ? 1 : 0));
    }
    solid[word] = pack_64(is_solid);
    unknown[word] = pack_64(is_unknown);
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void read_words_avx2(const CellReading& reading, const Prior* prior,
                                                     const std::int8_t* evidence, int words, std::uint64_t* solid,
                                                     std::uint64_t* unknown) {
  const auto all_of = [](auto value) __attribute__((target("avx2"))) {
    return _mm256_set1_epi8(static_cast<char>(value));
  };
  const __m256i wall = all_of(Prior::kOccupied);
  const __m256i other_wall = reading.disputed_is_wall ? all_of(Prior::kDisputed) : wall;
  const __m256i no_prior = all_of(Prior::kUnknown);
  const __m256i blocks = all_of(reading.unknown_blocks ? -1 : 0);
  const __m256i occupied = all_of(reading.occupied);
  const __m256i not_free = all_of(reading.not_free);
  for (int word = 0; word < words; ++word) {
    std::uint64_t solid_bits = 0;
    std::uint64_t unknown_bits = 0;
    _mm_prefetch(reinterpret_cast<const char*>(prior) + kAhead, _MM_HINT_T0);
    _mm_prefetch(reinterpret_cast<const char*>(evidence) + kAhead, _MM_HINT_T0);
    for (int half = 0; half < 2; ++half, prior += kWord / 2, evidence += kWord / 2) {
      const __m256i known = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(prior));
      const __m256i seen = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(evidence));
      const __m256i is_wall = _mm256_or_si256(_mm256_cmpeq_epi8(known, wall), _mm256_cmpeq_epi8(known, other_wall));
      const __m256i is_solid = _mm256_or_si256(is_wall, _mm256_cmpgt_epi8(seen, occupied));
      const __m256i may_be = _mm256_and_si256(_mm256_cmpeq_epi8(known, no_prior), blocks);
      const __m256i is_unknown = _mm256_and_si256(may_be, _mm256_cmpgt_epi8(seen, not_free));
      const auto bits_of = [](__m256i cells) __attribute__((target("avx2"))) {
        return std::uint64_t{static_cast<std::uint32_t>(_mm256_movemask_epi8(cells))};
      };
      solid_bits |= bits_of(is_solid) << (kWord / 2 * half);
      unknown_bits |= bits_of(is_unknown) << (kWord / 2 * half);
    }
    solid[word] = solid_bits;
    unknown[word] = unknown_bits;
  }
}
#endif

using ReadWords = void (*)(const CellReading&, const Prior*, const std::int8_t*, int, std::uint64_t*, std::uint64_t*);

ReadWords fastest_read() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    return read_words_avx2;
  }
#endif
  return read_words_plain;
}

void read_row(ReadWords read, const CellReading& reading, const Prior* prior, const std::int8_t* evidence, int columns,
              std::uint64_t* solid, std::uint64_t* unknown) {
  const int words = columns / kWord;
  read(reading, prior, evidence, words, solid, unknown);
  const int past = columns % kWord;
  if (past == 0) {
    return;
  }
  // the rest of the last word: free cells
  std::array<Prior, kWord> last_prior;
  std::array<std::int8_t, kWord> last_evidence;
  last_prior.fill(Prior::kFree);
  last_evidence.fill(-128);
  std::copy_n(prior + columns - past, past, last_prior.begin());
  std::copy_n(evidence + columns - past, past, last_evidence.begin());
  read(reading, last_prior.data(), last_evidence.data(), 1, solid + words, unknown + words);
}

}  // namespace

void read_cells(const CellReading& reading, const Prior* prior, const std::int8_t* evidence, int columns,
                std::uint64_t* solid, std::uint64_t* unknown) {
  static const ReadWords kRead = fastest_read();
  read_row(kRead, reading, prior, evidence, columns, solid, unknown);
}

void read_cells_plain(const CellReading& reading, const Prior* prior, const std::int8_t* evidence, int columns,
                      std::uint64_t* solid, std::uint64_t* unknown) {
  read_row(read_words_plain, reading, prior, evidence, columns, solid, unknown);
}

}  // namespace luminav
