#include "services/common/configuration/building_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/toml_lines.hpp"

namespace luminav {
namespace {

constexpr double kSame = 6e-4;  // a file has three or four digits

/// One table of a file, by the line of its header.
class EditedTable {
 public:
  EditedTable(TomlLines& lines, std::size_t header) : lines_(lines), header_(header) {}

  void set(const std::string& key, const std::string& value) { lines_.set_key(lines_.table_at(header_), key, value); }
  void erase(const std::string& key) { lines_.erase_key(lines_.table_at(header_), key); }

 private:
  TomlLines& lines_;
  std::size_t header_;
};

template <typename Item>
std::optional<std::size_t> find_named(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  return found == items.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - items.begin()));
}

/// Where an item is that is to be changed or removed; nothing for a new one.
template <typename Item>
std::optional<std::size_t> place_of(const char* what, const std::vector<Item>& items, const std::string& name) {
  if (name.empty()) {
    return std::nullopt;
  }
  const std::optional<std::size_t> found = find_named(items, name);
  if (!found) {
    throw ConfigurationError(fmt::format("there is no {} \"{}\"", what, name));
  }
  return found;
}

template <typename Item>
void set(const char* what, std::vector<Item>& items, const std::string& name, const Item& item) {
  const std::optional<std::size_t> old = place_of(what, items, name);
  if (item.name != name && find_named(items, item.name)) {
    throw ConfigurationError(fmt::format("there is a {} \"{}\" already", what, item.name));
  }
  if (old) {
    items[*old] = item;
  } else {
    items.push_back(item);
  }
}

template <typename Item>
void remove(const char* what, std::vector<Item>& items, const std::string& name) {
  if (const std::optional<std::size_t> found = place_of(what, items, name)) {
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(*found));
  }
}

bool near(double a, double b) {
  return std::abs(a - b) < kSame;
}

bool is_same(const Polygon& a, const Polygon& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) { return (p - q).norm() < 2.0 * kSame; });
}

bool is_same(const Zone& a, const Zone& b) {
  return a.name == b.name && a.kind == b.kind && is_same(a.polygon, b.polygon) &&
         (a.kind != ZoneKind::kSlow || near(a.speed, b.speed)) &&
         (a.kind != ZoneKind::kOneWay || near(wrap_angle(a.direction - b.direction), 0.0)) && a.hours == b.hours;
}

bool is_same(const Pose2& a, const Pose2& b) {
  return near(a.x, b.x) && near(a.y, b.y) && near(wrap_angle(a.theta - b.theta), 0.0);
}

bool is_same(const Place& a, const Place& b) {
  return a.name == b.name && a.has_theta == b.has_theta && is_same(a.pose, b.pose);
}

bool is_same(const Fixture& a, const Fixture& b) {
  return a.id == b.id && a.shape == b.shape && is_same(a.world_from_fixture, b.world_from_fixture) &&
         near(a.length, b.length) && near(a.width, b.width) && near(a.height, b.height) && a.lamps == b.lamps;
}

bool is_same(const CeilingElement& a, const CeilingElement& b) {
  return a.kind == b.kind && is_same(a.world_from_element, b.world_from_element) && near(a.length, b.length) &&
         near(a.width, b.width);
}

bool is_same(const Window& a, const Window& b) {
  return is_same(a.world_from_window, b.world_from_window) && near(a.width, b.width);
}

bool is_same(const Door& a, const Door& b) {
  return a.id == b.id && is_same(a.world_from_door, b.world_from_door) && near(a.width, b.width);
}

template <typename Item>
bool are_same(const std::vector<Item>& a, const std::vector<Item>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Item& one, const Item& other) { return is_same(one, other); });
}

void write(const Zone& zone, const Zone* old, EditedTable table) {
  table.set("name", quoted(zone.name));
  table.set("kind", quoted(name_of(zone.kind)));
  if (old == nullptr || !is_same(old->polygon, zone.polygon)) {  // else it stays as somebody has laid it out
    table.set("polygon", polygon_text(zone.polygon));
  }
  const auto set_or_erase = [&](const char* key, bool has, const std::string& value) {
    has ? table.set(key, value) : table.erase(key);
  };
  set_or_erase("speed", zone.kind == ZoneKind::kSlow, fmt::format("{:.3f}", zone.speed));
  set_or_erase("direction", zone.kind == ZoneKind::kOneWay, fmt::format("{:.4f}", zone.direction));
  const std::string span = span_text(zone.hours);
  const std::string days = days_text(zone.hours.days);
  set_or_erase("hours", !span.empty(), quoted(span));
  set_or_erase("days", !days.empty(), quoted(days));
}

void write(const Place& place, const Place* /*old*/, EditedTable table) {
  table.set("name", quoted(place.name));
  table.set("x", fmt::format("{:.3f}", place.pose.x));
  table.set("y", fmt::format("{:.3f}", place.pose.y));
  if (place.has_theta) {
    table.set("theta", fmt::format("{:.4f}", place.pose.theta));
  } else {
    table.erase("theta");
  }
}

template <typename Item>
void edit_table(TomlLines& lines, const std::string& what, const std::vector<Item>& items,
                const std::vector<int>& item_lines, const std::string& name, const Item* item) {
  const std::string header = "[[" + what + "]]";
  const std::optional<std::size_t> old = place_of(what.c_str(), items, name);
  if (!old) {
    lines.append("");
    lines.append(header);
    write(*item, nullptr, EditedTable(lines, lines.size() - 1));
    return;
  }
  const int line = item_lines[*old];  // counted from 1
  const auto at = static_cast<std::size_t>(std::max(1, line)) - 1;
  if (at >= lines.size() || !lines.is_header(at)) {
    throw ConfigurationError(
        fmt::format("line {} of the file is not a table of its own, must begin with {}", line, header));
  }
  if (item != nullptr) {
    write(*item, &items[*old], EditedTable(lines, at));
  } else {
    lines.erase(lines.table_at(at));
  }
}

}  // namespace

Building with_edit(const Building& building, const BuildingEdit& edit) {
  Building result = building;
  switch (edit.kind) {
    case BuildingEdit::Kind::kSetZone:
      set("zone", result.zones, edit.name, edit.zone);
      break;
    case BuildingEdit::Kind::kRemoveZone:
      remove("zone", result.zones, edit.name);
      break;
    case BuildingEdit::Kind::kSetPlace:
      set("place", result.places, edit.name, edit.place);
      break;
    case BuildingEdit::Kind::kRemovePlace:
      remove("place", result.places, edit.name);
      break;
  }
  return result;
}

std::string with_edit(const std::string& toml, const BuildingSource& source, const BuildingEdit& edit) {
  TomlLines lines(toml);
  const Building& building = source.building;
  const bool is_removal = edit.kind == BuildingEdit::Kind::kRemoveZone || edit.kind == BuildingEdit::Kind::kRemovePlace;
  if (is_removal && edit.name.empty()) {
    throw ConfigurationError("a name is needed of what is to be removed");
  }
  if (edit.kind == BuildingEdit::Kind::kSetZone || edit.kind == BuildingEdit::Kind::kRemoveZone) {
    edit_table(lines, "zone", building.zones, source.zone_lines, edit.name, is_removal ? nullptr : &edit.zone);
  } else {
    edit_table(lines, "place", building.places, source.place_lines, edit.name, is_removal ? nullptr : &edit.place);
  }
  return lines.text();
}

bool differ_in_zones_and_places_alone(const Building& a, const Building& b) {
  return a.name == b.name && a.search == b.search && near(a.ceiling_height, b.ceiling_height) &&
         a.map_file == b.map_file && are_same(a.fixtures, b.fixtures) && are_same(a.elements, b.elements) &&
         are_same(a.windows, b.windows) && are_same(a.doors, b.doors);
}

bool are_same_zones(const std::vector<Zone>& a, const std::vector<Zone>& b) {
  return are_same(a, b);
}

bool are_same_places(const std::vector<Place>& a, const std::vector<Place>& b) {
  return are_same(a, b);
}

}  // namespace luminav
