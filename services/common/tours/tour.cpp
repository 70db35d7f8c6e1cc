#include "services/common/tours/tour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <string_view>

namespace luminav {
namespace {

constexpr double kSamePause = 5e-4;  // [s] a file has three digits
constexpr std::array<std::string_view, 7> kDays{"Mo", "Tu", "We", "Th", "Fr", "Sa", "Su"};

std::optional<std::size_t> day_called(std::string_view word) {
  const auto found = std::find(kDays.begin(), kDays.end(), word);
  return found == kDays.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - kDays.begin()));
}

std::optional<int> number(std::string_view digits) {
  if (digits.empty() || digits.size() > 2 ||
      !std::all_of(digits.begin(), digits.end(), [](unsigned char digit) { return std::isdigit(digit) != 0; })) {
    return std::nullopt;
  }
  return std::stoi(std::string(digits));
}

bool is_same(const TourStop& a, const TourStop& b) {
  return a.place == b.place && std::abs(a.pause - b.pause) < kSamePause && a.text == b.text && a.photo == b.photo;
}

bool is_same(const Tour& a, const Tour& b) {
  return a.name == b.name && a.at == b.at && a.days == b.days &&
         std::equal(a.stops.begin(), a.stops.end(), b.stops.begin(), b.stops.end(),
                    [](const TourStop& one, const TourStop& other) { return is_same(one, other); });
}

}  // namespace

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

std::string time_of_day_text(int second) {
  return fmt::format("{:02}:{:02}", second / 3600, second / 60 % 60);
}

std::optional<Weekdays> read_days(const std::string& text) {
  std::string words = text;
  std::erase(words, ' ');
  Weekdays days{};
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
  return days == Weekdays{} ? std::nullopt : std::optional(days);
}

std::string days_text(const Weekdays& days) {
  std::string text;
  for (std::size_t first = 0; first < days.size(); ++first) {
    if (!days[first]) {
      continue;
    }
    std::size_t last = first;
    while (last + 1 < days.size() && days[last + 1]) {
      ++last;
    }
    if (last - first < 2) {
      last = first;  // two days are named, not spanned
    }
    text += text.empty() ? "" : ",";
    text += last == first ? std::string(kDays[first]) : fmt::format("{}-{}", kDays[first], kDays[last]);
    first = last;
  }
  return text;
}

bool are_same_tours(const std::vector<Tour>& a, const std::vector<Tour>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Tour& one, const Tour& other) { return is_same(one, other); });
}

}  // namespace luminav
