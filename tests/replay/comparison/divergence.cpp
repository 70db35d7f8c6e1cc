#include "tests/replay/comparison/divergence.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tests/replay/log_reading/message_schema.hpp"

namespace luminav {
namespace {

std::string text_of(const FieldValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.value)) {
    return fmt::format("{}", *integer);
  }
  if (const auto* number = std::get_if<double>(&value.value)) {
    return fmt::format("{}", *number);
  }
  return '"' + std::get<std::string>(value.value) + '"';
}

std::string first_difference(const LogEvent& recorded, const LogEvent& replayed) {
  if (recorded.fingerprint() != replayed.fingerprint()) {
    return "the type has changed since";
  }
  const auto was = MessageSchemas::built_in().decode(recorded.data);
  const auto is = MessageSchemas::built_in().decode(replayed.data);
  if (!was || !is) {
    return "does not decode";
  }
  for (std::size_t i = 0; i < was->size() && i < is->size(); ++i) {
    const FieldValue& a = (*was)[i];
    const FieldValue& b = (*is)[i];
    if (a.path != b.path) {
      return fmt::format("{} where {} was recorded", b.path, a.path);
    }
    if (a.value != b.value) {
      return fmt::format("{} recorded {} replayed {}", a.path, text_of(a), text_of(b));
    }
  }
  return was->size() == is->size() ? "binary data" : "another number of values";
}

}  // namespace

void DivergenceWatch::recorded(LogEvent event) {
  const std::string channel = event.channel;
  ++channels_[channel].recorded;
  waiting_[channel].recorded.push_back(std::move(event));
  compare(channel);
}

void DivergenceWatch::replayed(LogEvent event) {
  const std::string channel = event.channel;
  ++channels_[channel].replayed;
  waiting_[channel].replayed.push_back(std::move(event));
  compare(channel);
}

void DivergenceWatch::note(ChannelDivergence& divergence, std::int64_t utime, std::string what) {
  if (!divergence.differs) {
    divergence.differs = true;
    divergence.first_utime = utime;
    divergence.first_what = std::move(what);
  }
}

void DivergenceWatch::compare(const std::string& channel) {
  Waiting& waiting = waiting_[channel];
  ChannelDivergence& divergence = channels_[channel];
  while (!waiting.recorded.empty() && !waiting.replayed.empty()) {
    const LogEvent& was = waiting.recorded.front();
    const LogEvent& is = waiting.replayed.front();
    if (was.data == is.data) {
      ++divergence.identical;
    } else if (!divergence.differs) {
      note(divergence, std::min(was.utime, is.utime), first_difference(was, is));
    }
    waiting.recorded.pop_front();
    waiting.replayed.pop_front();
  }
}

void DivergenceWatch::finish() {
  for (auto& [channel, waiting] : waiting_) {
    if (!waiting.recorded.empty()) {
      note(channels_[channel], waiting.recorded.front().utime,
           fmt::format("{} recorded messages have no replayed one", waiting.recorded.size()));
    } else if (!waiting.replayed.empty()) {
      note(channels_[channel], waiting.replayed.front().utime,
           fmt::format("{} replayed messages have no recorded one", waiting.replayed.size()));
    }
  }
}

std::string DivergenceWatch::first_channel() const {
  std::string first;
  for (const auto& [channel, divergence] : channels_) {
    if (divergence.differs && divergence.recorded > 0 &&
        (first.empty() || divergence.first_utime < channels_.at(first).first_utime)) {
      first = channel;
    }
  }
  return first;
}

}  // namespace luminav
