#pragma once

#include <string>
#include <vector>

#include "services/common/tours/jobs_file.hpp"

namespace luminav {

/// One change of a building's stored tours.
struct TourEdit {
  enum class Kind { kSet, kRemove, kMove };
  Kind kind = Kind::kSet;
  std::string name{};    // of the one that is changed, removed or moved; "" = a new one
  Tour tour{};           // as it is to be
  std::string before{};  // the tour before which it is to stand; "" = the last
};

/// The tours after it. Throws ConfigurationError when there is none of that name, or the new name is taken.
std::vector<Tour> with_edit(const std::vector<Tour>& tours, const TourEdit& edit);

/// The text of a jobs.toml after it. A stop that stays keeps its lines, wherever it moves; all else stays as it is,
/// comments included. `source` is what `toml` says. Throws ConfigurationError.
std::string with_edit(const std::string& toml, const JobsSource& source, const TourEdit& edit);

}  // namespace luminav
