#pragma once

#include <array>
#include <cstddef>

namespace luminav {

/// What became of a guess.
enum class Verdict {
  kAccepted,
  kNoEdges,
  kWrongSize,
  kTooLittleInView,
  kNoLongSide,
  kUnequalSides,
  kNoEnd,
  kTooFewEdges,
  kTooUncertain,
  kNoContrast,
  kMuchAmiss,
  kMayBeAnother,
};

constexpr const char* to_string(Verdict verdict) {
  constexpr std::array kTexts{"accepted",
                              "no edges",
                              "too large or too small",
                              "too little in view",
                              "no edge along a long side",
                              "unequal edges",
                              "no end",
                              "too few edges",
                              "uncertain",
                              "hardly any contrast",
                              "too much of it is amiss",
                              "may be another kind"};
  static_assert(kTexts.size() == static_cast<std::size_t>(Verdict::kMayBeAnother) + 1);
  return kTexts[static_cast<std::size_t>(verdict)];
}

}  // namespace luminav
