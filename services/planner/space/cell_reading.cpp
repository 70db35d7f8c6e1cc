#include "services/planner/space/cell_reading.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "services/common/geometry/vector_clones.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace luminav {
namespace {

constexpr int kWord = 64;                       // cells a word
using Flags = std::array<std::uint8_t, kWord>;  // 0 or 0x80

std::uint64_t pack(const Flags& flags) {
  std::uint64_t bits = 0;
#if defined(__SSE2__)
  for (std::size_t i = 0; i < kWord; i += 16) {
    const __m128i some = _mm_loadu_si128(reinterpret_cast<const __m128i*>(flags.data() + i));
    bits |= std::uint64_t{static_cast<std::uint32_t>(_mm_movemask_epi8(some))} << i;
  }
#else
  for (std::size_t i = 0; i < kWord; ++i) {
    bits |= std::uint64_t{flags[i]} >> 7 << i;
  }
#endif
  return bits;
}

LUMINAV_VECTOR_CLONES
void read_words(const CellReading reading, const Prior* prior, const std::int8_t* evidence, int words,
                std::uint64_t* solid, std::uint64_t* unknown) {
  const Prior other_wall = reading.disputed_is_wall ? Prior::kDisputed : Prior::kOccupied;
  const std::uint8_t unknown_flag = reading.unknown_blocks ? 0x80 : 0;
  for (int word = 0; word < words; ++word, prior += kWord, evidence += kWord) {
    Flags is_solid;
    Flags is_unknown;
    for (std::size_t i = 0; i < kWord; ++i) {
      const bool is_wall = (prior[i] == Prior::kOccupied) | (prior[i] == other_wall);
      const bool may_block = (prior[i] == Prior::kUnknown) & (evidence[i] > reading.not_free);
      is_solid[i] = is_wall | (evidence[i] > reading.occupied) ? 0x80 : 0;
      is_unknown[i] = may_block ? unknown_flag : 0;
    }
    solid[word] = pack(is_solid);
    unknown[word] = pack(is_unknown);
  }
}

}  // namespace

void read_cells(const CellReading& reading, const Prior* prior, const std::int8_t* evidence, int columns,
                std::uint64_t* solid, std::uint64_t* unknown) {
  const int words = columns / kWord;
  read_words(reading, prior, evidence, words, solid, unknown);
  if (const int past = columns % kWord; past != 0) {
    // the rest of the last word: free cells
    std::array<Prior, kWord> last_prior;
    std::array<std::int8_t, kWord> last_evidence;
    last_prior.fill(Prior::kFree);
    last_evidence.fill(-128);
    std::copy_n(prior + columns - past, past, last_prior.begin());
    std::copy_n(evidence + columns - past, past, last_evidence.begin());
    read_words(reading, last_prior.data(), last_evidence.data(), 1, solid + words, unknown + words);
  }
}

}  // namespace luminav
