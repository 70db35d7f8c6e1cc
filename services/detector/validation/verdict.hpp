#pragma once

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
  kSidesEndEarly,
  kNotFilled,
  kGoesOnBeyondEnd,
  kTooFewEdges,
  kTooUncertain,
  kNoContrast,
  kNotAlone,
  kMayBeAnother,
};

constexpr const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kNoEdges:
      return "no edges";
    case Verdict::kWrongSize:
      return "too large or too small";
    case Verdict::kTooLittleInView:
      return "too little in view";
    case Verdict::kNoLongSide:
      return "no edge along a long side";
    case Verdict::kUnequalSides:
      return "sides of different brightness";
    case Verdict::kNoEnd:
      return "no edge at an end";
    case Verdict::kSidesEndEarly:
      return "long sides end early";
    case Verdict::kNotFilled:
      return "not filled";
    case Verdict::kGoesOnBeyondEnd:
      return "goes on beyond its end";
    case Verdict::kTooFewEdges:
      return "too few edges for a piece";
    case Verdict::kTooUncertain:
      return "too uncertain";
    case Verdict::kNoContrast:
      return "no brighter than its surroundings";
    case Verdict::kNotAlone:
      return "others like it beside it";
    case Verdict::kMayBeAnother:
      return "may be another kind";
  }
  return "";
}

}  // namespace luminav
