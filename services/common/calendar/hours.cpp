#include "services/common/calendar/hours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

namespace luminav {
namespace {

constexpr std::array<std::string_view, 7> kDayNames{"Mo", "Tu", "We", "Th", "Fr", "Sa", "Su"};

std::optional<std::size_t> day_called(std::string_view word) {
  const auto found = std::find(kDayNames.begin(), kDayNames.end(), word);
  return found == kDayNames.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - kDayNames.begin()));
}

std::optional<int> number(std::string_view digits) {
  if (digits.empty() || digits.size() > 2 ||
      !std::all_of(digits.begin(), digits.end(), [](unsigned char digit) { return std::isdigit(digit) != 0; })) {
    return std::nullopt;
  }
  return std::stoi(std::string(digits));
}

bool is_over_midnight(const Hours& hours) {
  return hours.end < hours.begin;
}

bool begin_on(const Hours& hours, int weekday) {
  return hours.days[static_cast<std::size_t>((weekday + 7) % 7)];
}

}  // namespace

bool hold(const Hours& hours, const LocalTime& now) {
  const bool today = begin_on(hours, now.weekday);
  if (!is_over_midnight(hours)) {
    return today && now.second >= hours.begin && now.second < hours.end;
  }
  return (today && now.second >= hours.begin) || (begin_on(hours, now.weekday - 1) && now.second < hours.end);
}

std::string end_of(const Hours& hours, const LocalTime& now) {
  if (are_always(hours)) {
    return "";
  }
  if (hours.begin != 0 || hours.end != kDaySeconds) {
    return time_of_day_text(hours.end);
  }
  int day = now.weekday + 1;
  while (begin_on(hours, day)) {
    ++day;
  }
  return fmt::format("{} 00:00", kDayNames[static_cast<std::size_t>(day % 7)]);
}

bool meet(const Hours& a, const Hours& b) {
  for (int minute = 0; minute < 7 * kDaySeconds / 60; ++minute) {
    const LocalTime now{0, minute * 60 / kDaySeconds, minute * 60 % kDaySeconds};
    if (hold(a, now) && hold(b, now)) {
      return true;
    }
  }
  return false;
}

std::optional<int> read_time_of_day(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    return std::nullopt;
  }
  const auto hours = number(std::string_view(text).substr(0, colon));
  const auto minutes = number(std::string_view(text).substr(colon + 1));
  if (!hours || !minutes || *hours > 23 || *minutes > 59) {
    return std::nullopt;
  }
  return 3600 * *hours + 60 * *minutes;
}

std::string time_of_day_text(int seconds) {
  return fmt::format("{:02}:{:02}", seconds / 3600 % 24, seconds / 60 % 60);
}

std::optional<std::pair<int, int>> read_span(const std::string& text) {
  std::string words = text;
  std::erase(words, ' ');
  const std::size_t dash = words.find('-');
  if (dash == std::string::npos) {
    return std::nullopt;
  }
  const auto begin = read_time_of_day(words.substr(0, dash));
  const auto end = read_time_of_day(words.substr(dash + 1));
  return begin && end && *begin != *end ? std::optional(std::pair(*begin, *end)) : std::nullopt;
}

std::optional<Days> read_days(const std::string& text) {
  std::string words = text;
  std::erase(words, ' ');
  Days days{};
  std::istringstream list(words);
  for (std::string item; std::getline(list, item, ',');) {
    const std::size_t dash = item.find('-');
    const auto first = day_called(std::string_view(item).substr(0, dash));
    const auto last = dash == std::string::npos ? first : day_called(std::string_view(item).substr(dash + 1));
    if (!first || !last) {
      return std::nullopt;
    }
    for (std::size_t day = *first; day != *last; day = (day + 1) % 7) {  // also over Sunday: Sa-Mo
      days[day] = true;
    }
    days[*last] = true;
  }
  return days == Days{} ? std::nullopt : std::optional(days);
}

std::string span_text(const Hours& hours) {
  const bool is_whole_day = hours.begin == 0 && hours.end == kDaySeconds;
  return is_whole_day ? "" : fmt::format("{}-{}", time_of_day_text(hours.begin), time_of_day_text(hours.end));
}

std::string days_text(const Days& days) {
  std::string text;
  for (std::size_t first = 0; first < days.size() && days != kEveryDay; ++first) {
    if (!days[first]) {
      continue;
    }
    std::size_t last = first;
    while (last + 1 < days.size() && days[last + 1]) {
      ++last;
    }
    text += fmt::format("{}{}", text.empty() ? "" : ",", kDayNames[first]);
    text += last == first ? "" : fmt::format("{}{}", last == first + 1 ? "," : "-", kDayNames[last]);
    first = last;
  }
  return text;
}

std::string text_of(const Hours& hours) {
  const std::string days = days_text(hours.days);
  const std::string span = span_text(hours);
  return days + (days.empty() || span.empty() ? "" : " ") + span;
}

}  // namespace luminav
