#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/contract/clause.hpp"

namespace luminav {

struct StreamParams {
  std::string channel;
  double rate = 10.0;        // [Hz] at least
  double longest_gap = 0.3;  // [s] between two stamps
};

/// What every message of a driver says of itself.
struct StreamHead {
  std::int64_t arrival = 0;  // [us] by the listener's clock
  std::int64_t utime = 0;    // [us] the message's stamp
  std::int64_t session = 0;  // sequences count within it
  std::int32_t sequence = 0;
};

/// Holds one channel of a driver to its rate, its stamps and its sequence. The rate is that of arrivals: stamps may
/// lie.
class StreamWatch {
 public:
  explicit StreamWatch(const StreamParams& params);

  void hear(const StreamHead& head);
  /// To be asked at the end: a channel of which nothing came by then is broken.
  [[nodiscard]] std::vector<Clause> clauses() const;

 private:
  [[nodiscard]] double span(std::int64_t StreamHead::*time) const;  // [s] from the first message to the last

  StreamParams params_;
  std::int64_t count_ = 0;
  std::int64_t lost_ = 0;
  StreamHead first_;
  StreamHead last_;
  double longest_gap_ = 0.0;  // [s]
  Clause stamps_;
  Clause sequence_;
};

}  // namespace luminav
