#include "services/jobs/tour_schedule.hpp"

namespace luminav {
namespace {

constexpr int kLateness = 120;  // [s] that a start may come late

}  // namespace

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
