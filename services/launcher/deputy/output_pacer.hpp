#pragma once

#include <cstdint>
#include <luminav_procman/procman_output_t.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace luminav::launcher {

struct OutputPacerParams {
  double command_rate = 16'000;   // [bytes/s] that one command may send for long
  double command_burst = 32'000;  // [bytes] at once after a pause
  std::size_t largest = 60'000;   // [bytes] of text and names in one message: one datagram holds 65,499
};

/// Collects what the commands print and packs it into PM_OUTPUT messages that fit a datagram. What is too much to send
/// is left out, and said so; the log files have all of it.
class OutputPacer {
 public:
  explicit OutputPacer(const OutputPacerParams& params) : params_(params) {}

  /// "" is the deputy itself.
  void add(const std::string& command_id, std::string_view text, std::int64_t steady_now);
  /// Everything collected since the last call; deputy_id and utime are the caller's.
  [[nodiscard]] std::vector<luminav_procman::procman_output_t> take(std::int64_t steady_now);

 private:
  struct Stream {
    std::string text;
    double allowance = 0.0;   // [bytes]
    std::int64_t filled = 0;  // [us] when the allowance was last brought up to date
    bool known = false;
    std::int64_t left_out = 0;  // [bytes]
  };
  void refill(Stream& stream, std::int64_t steady_now) const;

  OutputPacerParams params_;
  std::map<std::string, Stream> streams_;
};

}  // namespace luminav::launcher
