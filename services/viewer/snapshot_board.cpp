#include "services/viewer/snapshot_board.hpp"

#include <fmt/format.h>

namespace luminav {

std::string server_sent_event(std::string_view name, std::string_view json) {
  return fmt::format("event: {}\ndata: {}\n\n", name, json);
}

std::string json_of(const std::string& server_sent_event) {
  constexpr std::string_view kData = "\ndata: ";
  const std::size_t begin = server_sent_event.find(kData) + kData.size();
  return server_sent_event.substr(begin, server_sent_event.size() - begin - 2);
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
  const std::lock_guard lock(mutex_);
  ++tick_;
  if (wake_) {
    wake_();
  }
}

void SnapshotBoard::report_ticks(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
}

SnapshotBoard::Cursor SnapshotBoard::new_reader() const {
  const std::lock_guard lock(mutex_);
  return {.tick = tick_};
}

std::vector<SnapshotBoard::Text> SnapshotBoard::read(Cursor& cursor, std::size_t bulk_budget) const {
  const std::lock_guard lock(mutex_);
  std::vector<Text> texts;
  if (cursor.tick == tick_) {
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

SnapshotBoard::Text SnapshotBoard::newest(Lane lane, const std::string& subject) const {
  const std::lock_guard lock(mutex_);
  const auto& entries = lanes_[static_cast<std::size_t>(lane)].entries;
  const auto found = entries.find(subject);
  return found == entries.end() ? nullptr : found->second.text;
}

std::vector<SnapshotBoard::Text> SnapshotBoard::all(Lane lane) const {
  const std::lock_guard lock(mutex_);
  std::vector<Text> texts;
  for (const auto& [subject, entry] : lanes_[static_cast<std::size_t>(lane)].entries) {
    texts.push_back(entry.text);
  }
  return texts;
}

}  // namespace luminav
