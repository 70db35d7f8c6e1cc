#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/common/log/log_file.hpp"

namespace luminav {

/// Where the messages of a log stand in its file, and what a person may want to look at. Holds no messages: a log of
/// hours with pictures has gigabytes. Times are [us] since the first message; where the recorder's clock went back,
/// they stand still.
class LogIndex {
 public:
  struct Entry {
    std::int64_t at = 0;         // [us]
    std::uint64_t position = 0;  // [bytes] for LogReader::go_to
    std::size_t subject = 0;     // messages of one subject replace each other
  };
  struct Mark {
    enum class Kind { kGoal, kStop, kLost };
    std::int64_t at = 0;  // [us]
    Kind kind = Kind::kGoal;
    std::string text;  // a place, or why; may be ""
  };

  /// Reads the whole log once.
  explicit LogIndex(LogReader& reader);

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] const std::vector<Mark>& marks() const { return marks_; }
  /// [us] since the epoch, when the first message was received.
  [[nodiscard]] std::int64_t begin() const { return begin_; }
  [[nodiscard]] std::int64_t duration() const { return entries_.empty() ? 0 : entries_.back().at; }

  /// How many entries are not later than `at`.
  [[nodiscard]] std::size_t count_until(std::int64_t at) const;
  /// What a listener must have heard to know what was known at `at`: the newest message of each subject, which are the
  /// channels, the map's tiles and the processes, and all of the last second. In the order of the log.
  [[nodiscard]] std::vector<Entry> needed_at(std::int64_t at) const;

 private:
  std::size_t subject_of(const LogEvent& event);
  void mark(const LogEvent& event, std::int64_t at);
  void mark_pose(const LogEvent& event, std::int64_t at);
  void mark_goal(const LogEvent& event, std::int64_t at);
  void mark_stop(const LogEvent& event, std::int64_t at);

  std::vector<Entry> entries_;
  std::vector<Mark> marks_;
  std::map<std::string, std::size_t> subjects_;
  std::int64_t begin_ = 0;  // [us]
  bool was_tracking_ = false;
  bool was_stopped_ = false;
  std::int64_t goal_id_ = 0;
};

/// "goal", "stop" or "lost".
const char* name_of(LogIndex::Mark::Kind kind);

}  // namespace luminav
