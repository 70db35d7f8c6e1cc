#pragma once

#include <string>
#include <vector>

#include "services/common/tours/tour_edit.hpp"

namespace luminav {

/// What a person wants of the stored tours: one change, or the last one undone.
struct TourOrder {
  std::string version{};  // that the person has before his eyes
  bool accepts = false;   // also with what checking finds
  bool undoes = false;
  TourEdit edit{};  // unless it undoes
};

/// {"version", "action": "set_tour", "tour": {"name", "stops": [{"place", "pause"?, "text"?, "photo"?}, ...], "at"?:
/// "09:30", "days"?: ["Mo", ...]}, "name"?: which one it replaces, "accept"?}; "remove_tour" with "name"; "move_tour"
/// with "name" and "before"?: the one before which it is to stand, else the last; "undo". Throws RequestError, as those
/// in request_text.hpp do.
TourOrder read_tour_order(const std::string& body);

/// A list of tours, as an order has them.
std::string tours_json(const std::vector<Tour>& tours);

}  // namespace luminav
