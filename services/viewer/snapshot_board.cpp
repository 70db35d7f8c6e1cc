#include "services/viewer/snapshot_board.hpp"

#include <fmt/format.h>

#include <chrono>

namespace luminav {

std::string server_sent_event(std::string_view name, std::string_view json) {
  return fmt::format("event: {}\ndata: {}\n\n", name, json);
}

void SnapshotBoard::put(Lane lane, const std::string& subject, std::string text) {
  auto shared = std::make_shared<const std::string>(std::move(text));
  const std::lock_guard lock(mutex_);
  Content& content = lanes_[static_cast<std::size_t>(lane)];
  Entry& entry = content.entries[subject];
  content.by_version.erase(entry.version);
  entry.version = ++version_;
  entry.text = std::move(shared);
  content.by_version.emplace(entry.version, subject);
}

void SnapshotBoard::clear(Lane lane) {
  const std::lock_guard lock(mutex_);
  lanes_[static_cast<std::size_t>(lane)] = {};
}

void SnapshotBoard::tick() {
  {
    const std::lock_guard lock(mutex_);
    ++tick_;
  }
  changed_.notify_all();
}

void SnapshotBoard::close() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
}

bool SnapshotBoard::is_closed() const {
  const std::lock_guard lock(mutex_);
  return is_closed_;
}

std::vector<SnapshotBoard::Text> SnapshotBoard::read(Cursor& cursor, int patience_ms, std::size_t bulk_budget) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::milliseconds(patience_ms), [&] { return is_closed_ || tick_ != cursor.tick; });
  std::vector<Text> texts;
  if (is_closed_) {
    return texts;
  }
  cursor.tick = tick_;
  for (const Lane lane : {Lane::kLive, Lane::kBulk}) {
    const Content& content = lanes_[static_cast<std::size_t>(lane)];
    std::uint64_t& seen = cursor.seen[static_cast<std::size_t>(lane)];
    std::size_t taken = 0;  // [bytes]
    for (auto next = content.by_version.upper_bound(seen); next != content.by_version.end(); ++next) {
      const Text& text = content.entries.at(next->second).text;
      if (lane == Lane::kBulk && taken > 0 && taken + text->size() > bulk_budget) {
        break;
      }
      taken += text->size();
      texts.push_back(text);
      seen = next->first;
    }
  }
  return texts;
}

}  // namespace luminav
