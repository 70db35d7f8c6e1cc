#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/calendar/hours.hpp"

namespace luminav {

/// Where a stored tour leads.
struct TourStop {
  std::string place{};  ///< of the building
  double pause = 0.0;   ///< [s] to stay there
  std::string text{};   ///< for people there
  bool photo = false;   ///< the camera's picture there is kept
};

/// A tour of the building's jobs file.
struct Tour {
  std::string name{};
  std::vector<TourStop> stops{};
  std::optional<int> at{};  ///< [s] since midnight; nothing = only when somebody asks for it
  Days days = kEveryDay;
};

inline constexpr std::size_t kMaxTours = 50;         // their names fit into one datagram beside the jobs
inline constexpr std::size_t kMaxTourStops = 20;     // as many as a job has
inline constexpr std::size_t kMaxTourText = 200;     // [bytes]
inline constexpr double kLongestTourPause = 3600.0;  // [s]

/// True if they are the same in the same order, pauses to the half of a millisecond.
bool are_same_tours(const std::vector<Tour>& a, const std::vector<Tour>& b);

}  // namespace luminav
