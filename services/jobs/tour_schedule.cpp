#include "services/jobs/tour_schedule.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

namespace luminav {
namespace {

constexpr int kLateness = 120;  // [s] that a start may come late
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

std::optional<std::array<bool, 7>> read_days(const std::string& text) {
  std::string words = text;
  std::erase(words, ' ');
  std::array<bool, 7> days{};
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
  return days == std::array<bool, 7>{} ? std::nullopt : std::optional(days);
}

std::vector<const StoredTour*> due_tours(const std::vector<StoredTour>& tours, const LocalTime& now,
                                         const std::map<std::string, int>& started) {
  std::vector<const StoredTour*> due;
  for (const StoredTour& tour : tours) {
    const auto last = started.find(tour.name);
    const bool was_started = last != started.end() && last->second == now.day;
    if (tour.at && now.second >= *tour.at && now.second - *tour.at < kLateness && !was_started &&
        tour.days[static_cast<std::size_t>(now.weekday)]) {
      due.push_back(&tour);
    }
  }
  return due;
}

}  // namespace luminav
