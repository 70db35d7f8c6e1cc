#pragma once

#include <string>
#include <utility>

namespace luminav {

/// One sentence of the contract between a base driver and the rest, and what was seen of it.
class Clause {
 public:
  enum class Verdict { kNotSeen, kHolds, kBroken };

  explicit Clause(std::string text) : text_(std::move(text)) {}

  /// It was put to the test and held; the newest evidence is kept.
  void keep(std::string evidence = {}) {
    seen_ = true;
    if (breaches_ == 0) {
      evidence_ = std::move(evidence);
    }
  }
  /// It did not hold; the first evidence is kept.
  void breach(std::string evidence) {
    if (++breaches_ == 1) {
      evidence_ = std::move(evidence);
    }
  }
  void judge(bool holds, std::string evidence) { holds ? keep(std::move(evidence)) : breach(std::move(evidence)); }

  /// The same where only the breach has something to tell.
  void require(bool holds, std::string complaint) { holds ? keep() : breach(std::move(complaint)); }

  [[nodiscard]] Verdict verdict() const {
    return breaches_ > 0 ? Verdict::kBroken : seen_ ? Verdict::kHolds : Verdict::kNotSeen;
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::string& evidence() const { return evidence_; }
  [[nodiscard]] int breaches() const { return breaches_; }

 private:
  std::string text_;
  std::string evidence_;
  bool seen_ = false;
  int breaches_ = 0;
};

}  // namespace luminav
