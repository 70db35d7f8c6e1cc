#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace luminav {

/// A text as a browser's EventSource takes it. `json` on one line.
std::string server_sent_event(std::string_view name, std::string_view json);
/// The JSON in such a text.
std::string json_of(const std::string& server_sent_event);

/// What browsers are shown: the newest text per subject, and nothing older. A reader that falls behind skips what was
/// replaced meanwhile, so memory is bounded by the number of subjects however slow or dead the readers are.
/// Thread-safe.
class SnapshotBoard {
 public:
  /// Live subjects are always handed out whole; bulk ones (map tiles) within a budget per reading, so that a large map
  /// cannot delay the robot's state.
  /// What is asked for by name alone is handed to no reader.
  enum class Lane : std::size_t { kLive = 0, kBulk = 1, kAsked = 2 };
  using Text = std::shared_ptr<const std::string>;

  /// How far one reader has read; a fresh one is given everything.
  struct Cursor {
    std::array<std::uint64_t, 2> seen{};
    std::uint64_t tick = 0;  // there is nothing new until the next
  };

  /// Replaces the text of a subject. Readers see it after the next tick.
  void put(Lane lane, const std::string& subject, std::string text);
  /// Forgets all subjects of a lane.
  void clear(Lane lane);
  /// What was put is complete, and may be read.
  void tick();
  /// Whom each tick wakes; called from the thread that ticks. null = nobody any more.
  void report_ticks(std::function<void()> wake);

  /// For a reader that begins with the next tick.
  [[nodiscard]] Cursor new_reader() const;
  /// What changed since the cursor, oldest first, live before bulk; empty when there was no tick since. At least one
  /// bulk text is handed out however small the budget [bytes].
  [[nodiscard]] std::vector<Text> read(Cursor& cursor, std::size_t bulk_budget) const;
  /// The newest text of a subject; null when there is none.
  [[nodiscard]] Text newest(Lane lane, const std::string& subject) const;
  /// The newest text of each subject, by name.
  [[nodiscard]] std::vector<Text> all(Lane lane) const;

 private:
  struct Entry {
    std::uint64_t version = 0;
    Text text;
  };
  struct Content {
    std::map<std::string, Entry> entries;
    std::map<std::uint64_t, std::string> by_version;
  };

  mutable std::mutex mutex_;
  std::function<void()> wake_;
  std::array<Content, 3> lanes_;
  std::uint64_t version_ = 0;
  std::uint64_t tick_ = 1;  // above a fresh cursor's
};

}  // namespace luminav
