#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "services/common/log/log_file.hpp"
#include "services/viewer/playback/log_index.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {

/// Plays a recorded log: hands out its messages at the pace that people ask for. Reads no clock, but is told how much
/// time has passed. `order`, `json` and `state_json` may be called from any thread, `advance` from one.
class LogPlayer {
 public:
  struct Stage {
    /// What was heard so far no longer holds: a jump.
    std::function<void()> start_anew;
    /// A message; `at` [us] since the beginning of the log.
    std::function<void(const LogEvent& event, std::int64_t at)> feed;
  };

  /// Stands still at the beginning. Throws std::runtime_error for a file that is no log.
  explicit LogPlayer(const std::string& file);

  /// Carried out by the next `advance`.
  void order(const PlaybackOrder& order);
  /// `elapsed` [us] of people's time have passed.
  void advance(std::int64_t elapsed, const Stage& stage);

  [[nodiscard]] const LogIndex& index() const { return index_; }
  /// [us] since the beginning.
  [[nodiscard]] std::int64_t position() const { return position_; }
  /// {"file": ..., "position": ..., ...}, see PlaybackState in openapi.json.
  [[nodiscard]] std::string state_json() const;
  /// {"state": ..., "marks": [...]}.
  [[nodiscard]] std::string json() const;

 private:
  void jump(std::int64_t target, const Stage& stage);
  void feed(const LogIndex::Entry& entry, const Stage& stage);

  std::string file_;
  LogReader reader_;
  LogIndex index_;
  std::string damage_;
  std::size_t next_ = 0;                    // entry
  std::atomic<std::int64_t> position_ = 0;  // [us]
  mutable std::mutex mutex_;                // of what follows
  bool is_playing_ = false;
  double speed_ = 1.0;
  std::optional<std::int64_t> target_;  // [us] of a jump that is due
  int jumps_ = 0;
};

}  // namespace luminav
