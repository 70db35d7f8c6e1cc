#pragma once

#include <string>
#include <string_view>

#include "services/common/configuration/building_edit.hpp"

namespace luminav {

/// What a person wants of a building: one change of its zones or places, or the last one undone.
struct BuildingOrder {
  std::string version{};  // that the person has before his eyes
  bool accepts = false;   // also with what check-building finds wrong
  bool undoes = false;
  BuildingEdit edit{};  // unless it undoes
};

/// {"version", "action": "set_zone", "zone": {"name", "kind", "polygon": [[x, y], ...], "speed"? of a slow one,
/// "direction"? of a one-way one, "hours"?, "days"? as in the building's file}, "name"?: which one it replaces,
/// "accept"?}; with "remove_zone" and "remove_place" just "name"; "set_place" with "place": {"name", "x", "y",
/// "theta"?}; "undo". Throws RequestError, as those in request_text.hpp do.
BuildingOrder read_building_order(const std::string& body);

}  // namespace luminav
