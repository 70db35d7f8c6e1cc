#include "services/viewer/playback/log_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "services/viewer/message_json.hpp"

namespace luminav {

LogPlayer::LogPlayer(const std::string& file)
    : file_(std::filesystem::path(file).filename().string()),
      reader_(file),
      index_(reader_),
      damage_(reader_.damage()) {
  reader_.load_all();
}

void LogPlayer::order(const PlaybackOrder& order) {
  const std::lock_guard lock(mutex_);
  is_playing_ = order.playing.value_or(is_playing_);
  speed_ = order.speed.value_or(speed_);
  if (order.position) {
    target_ = std::clamp(static_cast<std::int64_t>(*order.position * 1e6), std::int64_t{0}, index_.duration());
  } else if (order.playing.value_or(false) && position_ >= index_.duration()) {
    target_ = 0;  // once more
  }
}

void LogPlayer::advance(std::int64_t elapsed, const Stage& stage) {
  std::optional<std::int64_t> target;
  std::int64_t step = 0;  // [us] of the log
  {
    const std::lock_guard lock(mutex_);
    std::swap(target, target_);
    jumps_ += target ? 1 : 0;
    step = is_playing_ ? static_cast<std::int64_t>(static_cast<double>(elapsed) * speed_) : 0;
  }
  if (target) {
    jump(*target, stage);
  }
  const std::int64_t end = std::min(position_ + step, index_.duration());
  position_ = end;
  for (; next_ < index_.entries().size() && index_.entries()[next_].at <= end; ++next_) {
    feed(index_.entries()[next_], stage);
  }
  if (end >= index_.duration()) {
    const std::lock_guard lock(mutex_);
    is_playing_ = is_playing_ && target_.has_value();
  }
}

void LogPlayer::jump(std::int64_t target, const Stage& stage) {
  position_ = target;
  stage.start_anew();
  for (const LogIndex::Entry& entry : index_.needed_at(target)) {
    feed(entry, stage);
  }
  next_ = index_.count_until(target);
}

void LogPlayer::feed(const LogIndex::Entry& entry, const Stage& stage) {
  LogEvent event;
  reader_.go_to(entry.position);
  if (reader_.next(event)) {
    stage.feed(event, entry.at);
  }
}

std::string LogPlayer::state_json() const {
  const std::lock_guard lock(mutex_);
  return fmt::format(
      R"({{"file":{},"begin":{},"duration":{:.3f},"position":{:.3f},"playing":{},"speed":{},"jumps":{},"damage":{}}})",
      to_json(std::string_view(file_)), index_.begin(), static_cast<double>(index_.duration()) * 1e-6,
      static_cast<double>(position_) * 1e-6, is_playing_, speed_, jumps_, to_json(std::string_view(damage_)));
}

std::string LogPlayer::json() const {
  std::string marks;
  for (const LogIndex::Mark& mark : index_.marks()) {
    marks += fmt::format(R"({}{{"at":{:.3f},"kind":"{}","text":{}}})", marks.empty() ? "" : ",",
                         static_cast<double>(mark.at) * 1e-6, name_of(mark.kind), to_json(std::string_view(mark.text)));
  }
  return fmt::format(R"({{"state":{},"marks":[{}]}})", state_json(), marks);
}

}  // namespace luminav
