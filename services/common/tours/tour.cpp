#include "services/common/tours/tour.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSamePause = 5e-4;  // [s] a file has three digits

bool is_same(const TourStop& a, const TourStop& b) {
  return a.place == b.place && std::abs(a.pause - b.pause) < kSamePause && a.text == b.text && a.photo == b.photo;
}

bool is_same(const Tour& a, const Tour& b) {
  return a.name == b.name && a.at == b.at && a.days == b.days &&
         std::equal(a.stops.begin(), a.stops.end(), b.stops.begin(), b.stops.end(),
                    [](const TourStop& one, const TourStop& other) { return is_same(one, other); });
}

}  // namespace

bool are_same_tours(const std::vector<Tour>& a, const std::vector<Tour>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Tour& one, const Tour& other) { return is_same(one, other); });
}

}  // namespace luminav
