#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace luminav {

/// The rates [bit/s] at which a robot may listen, in the order they are tried, since it keeps the one that an earlier
/// session has set; and the fast one, to which each session may switch once.
class LineRates {
 public:
  /// `first` is tried first; `fast` 0 = never switch.
  LineRates(int first, int fast) : fast_(fast), rates_{first} {
    for (const int rate : {fast, 9600, 38400, 19200, 115200, 57600}) {
      if (rate != 0 && std::find(rates_.begin(), rates_.end(), rate) == rates_.end()) {
        rates_.push_back(rate);
      }
    }
  }

  /// The line was opened at the first rate.
  void restart() { index_ = 0; }
  /// Goes on to the next rate; false when all were tried.
  [[nodiscard]] bool advance() { return ++index_ < rates_.size(); }
  [[nodiscard]] int current() const { return rates_[index_]; }

  void begin_session() { has_switched_ = false; }
  [[nodiscard]] bool wants_fast(int baud) const { return !has_switched_ && baud > 0 && fast_ > baud; }
  /// The session tries the fast rate, which is returned.
  int switch_to_fast() {
    has_switched_ = true;
    return fast_;
  }

 private:
  int fast_;
  std::vector<int> rates_;
  std::size_t index_ = 0;
  bool has_switched_ = false;
};

}  // namespace luminav
