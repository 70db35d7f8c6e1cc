#include "services/viewer/building/building_order.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <tuple>

#include "services/common/geometry/angle.hpp"
#include "services/viewer/http/request_fields.hpp"

namespace luminav {
namespace {

using Json = nlohmann::json;

constexpr double kFarthest = 10'000.0;  // [m]
constexpr std::size_t kMaxCorners = 100;

Polygon read_polygon(const Json& zone) {
  const auto found = zone.find("polygon");
  if (found == zone.end() || !found->is_array() || found->size() < 3 || found->size() > kMaxCorners) {
    throw RequestError(fmt::format("polygon: must be a list of 3 to {} corners", kMaxCorners));
  }
  Polygon polygon;
  for (const Json& corner : *found) {
    if (!corner.is_array() || corner.size() != 2) {
      throw RequestError("polygon: each corner must be [x, y]");
    }
    const Json named = {{"x", corner[0]}, {"y", corner[1]}};
    polygon.emplace_back(number(named, "x", -kFarthest, kFarthest), number(named, "y", -kFarthest, kFarthest));
  }
  if (!is_simple(polygon)) {
    throw RequestError("polygon: its edges must not cross");
  }
  return polygon;
}

Hours read_hours(const Json& zone) {
  Hours hours;
  if (zone.contains("hours")) {
    const auto span = read_span(text(zone, "hours"));
    if (!span) {
      throw RequestError("hours: must be two times of day that differ, as 08:00-12:00 or 22:00-06:00");
    }
    std::tie(hours.begin, hours.end) = *span;
  }
  if (zone.contains("days")) {
    const auto days = read_days(text(zone, "days"));
    if (!days) {
      throw RequestError("days: must be days as Mo-Fr or Tu,Sa");
    }
    hours.days = *days;
  }
  return hours;
}

Zone read_zone(const Json& item) {
  check_item(item, "zone", {"name", "kind", "polygon", "speed", "direction", "hours", "days"});
  Zone zone;
  zone.name = name(item, "name");
  zone.kind = static_cast<ZoneKind>(choice(item, "kind", {"keep-out", "slow", "one-way", "quiet"}));
  zone.polygon = read_polygon(item);
  zone.speed = zone.kind == ZoneKind::kSlow ? number(item, "speed", 0.05, 2.0) : zone.speed;
  zone.direction = zone.kind == ZoneKind::kOneWay ? wrap_angle(number(item, "direction", -7.0, 7.0)) : 0.0;
  zone.hours = read_hours(item);
  return zone;
}

Place read_place(const Json& item) {
  check_item(item, "place", {"name", "x", "y", "theta"});
  Place place;
  place.name = name(item, "name");
  place.pose.x = number(item, "x", -kFarthest, kFarthest);
  place.pose.y = number(item, "y", -kFarthest, kFarthest);
  place.has_theta = item.contains("theta");
  place.pose.theta = place.has_theta ? wrap_angle(number(item, "theta", -7.0, 7.0)) : 0.0;
  return place;
}

}  // namespace

BuildingOrder read_building_order(const std::string& body) {
  const Json object = read_object(body, {"version", "action", "name", "zone", "place", "accept"});
  BuildingOrder order;
  order.version = text(object, "version");
  order.accepts = object.contains("accept") && boolean(object, "accept");
  BuildingEdit& edit = order.edit;
  switch (choice(object, "action", {"set_zone", "remove_zone", "set_place", "remove_place", "undo"})) {
    case 0:
      edit.kind = BuildingEdit::Kind::kSetZone;
      edit.zone = read_zone(part(object, "zone"));
      break;
    case 1:
      edit.kind = BuildingEdit::Kind::kRemoveZone;
      break;
    case 2:
      edit.kind = BuildingEdit::Kind::kSetPlace;
      edit.place = read_place(part(object, "place"));
      break;
    case 3:
      edit.kind = BuildingEdit::Kind::kRemovePlace;
      break;
    default:
      order.undoes = true;
  }
  const bool is_removal = edit.kind == BuildingEdit::Kind::kRemoveZone || edit.kind == BuildingEdit::Kind::kRemovePlace;
  if (is_removal || object.contains("name")) {
    edit.name = text(object, "name");
  }
  if (is_removal && edit.name.empty()) {
    throw RequestError("name: must be that of what is to be removed");
  }
  return order;
}

}  // namespace luminav
