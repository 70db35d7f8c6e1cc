#pragma once

#include <string>
#include <vector>

#include "services/common/configuration/building_file.hpp"

namespace luminav {

/// One change of a building's zones or places.
struct BuildingEdit {
  enum class Kind { kSetZone, kRemoveZone, kSetPlace, kRemovePlace };
  Kind kind = Kind::kSetZone;
  std::string name{};  // of the one that is changed or removed; "" = a new one
  Zone zone{};         // as it is to be
  Place place{};       // as it is to be
};

/// The building after it. Throws ConfigurationError when there is none of that name, or the new name is taken.
Building with_edit(const Building& building, const BuildingEdit& edit);

/// The text of a building.toml after it: keys of the zone's or the place's table in their old place, or a new table at
/// the end. All else stays as it is, comments included. `source` is what `toml` says. Throws ConfigurationError.
std::string with_edit(const std::string& toml, const BuildingSource& source, const BuildingEdit& edit);

/// True if two buildings have the same map, fixtures and so on: they may differ in zones and places.
bool differ_in_zones_and_places_alone(const Building& a, const Building& b);

/// True if they are the same in the same order, to the half of a millimetre.
bool are_same_zones(const std::vector<Zone>& a, const std::vector<Zone>& b);
bool are_same_places(const std::vector<Place>& a, const std::vector<Place>& b);

}  // namespace luminav
