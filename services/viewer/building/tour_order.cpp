#include "services/viewer/building/tour_order.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "services/viewer/http/request_fields.hpp"

namespace luminav {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kDays = 7;

const Json& list(const Json& object, const char* key, std::size_t max) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->empty() || found->size() > max) {
    throw RequestError(fmt::format("{}: must be a list of 1 to {}", key, max));
  }
  return *found;
}

TourStop read_stop(const Json& item) {
  check_item(item, "stops", {"place", "pause", "text", "photo"});
  TourStop stop;
  stop.place = text(item, "place");
  stop.pause = item.contains("pause") ? number(item, "pause", 0.0, kLongestTourPause) : 0.0;
  stop.text = item.contains("text") ? line(item, "text", kMaxTourText) : "";
  stop.photo = item.contains("photo") && boolean(item, "photo");
  return stop;
}

Days read_weekdays(const Json& item) {
  Days days{};
  for (const Json& day : list(item, "days", kDays)) {
    const Json named = {{"days", day}};
    days.at(static_cast<std::size_t>(choice(named, "days", {"Mo", "Tu", "We", "Th", "Fr", "Sa", "Su"}))) = true;
  }
  return days;
}

Tour read_tour(const Json& item) {
  check_item(item, "tour", {"name", "stops", "at", "days"});
  Tour tour;
  tour.name = name(item, "name");
  for (const Json& stop : list(item, "stops", kMaxTourStops)) {
    tour.stops.push_back(read_stop(stop));
  }
  if (item.contains("at")) {
    tour.at = read_time_of_day(text(item, "at"));
    if (!tour.at) {
      throw RequestError("at: must be a time of day as 09:30");
    }
  }
  tour.days = item.contains("days") ? read_weekdays(item) : kEveryDay;
  return tour;
}

Json json_of(const Tour& tour) {
  Json stops = Json::array();
  for (const TourStop& stop : tour.stops) {
    stops.push_back({{"place", stop.place}, {"pause", stop.pause}, {"text", stop.text}, {"photo", stop.photo}});
  }
  Json days = Json::array();
  for (std::size_t day = 0; day < tour.days.size(); ++day) {
    Days one{};
    one.at(day) = true;
    if (tour.days.at(day)) {
      days.push_back(days_text(one));
    }
  }
  Json json = {{"name", tour.name}, {"stops", stops}, {"days", days}};
  if (tour.at) {
    json["at"] = time_of_day_text(*tour.at);
  }
  return json;
}

}  // namespace

TourOrder read_tour_order(const std::string& body) {
  const Json object = read_object(body, {"version", "action", "name", "tour", "before", "accept"});
  TourOrder order;
  order.version = text(object, "version");
  order.accepts = object.contains("accept") && boolean(object, "accept");
  const std::int8_t action = choice(object, "action", {"set_tour", "remove_tour", "move_tour", "undo"});
  order.undoes = action == 3;
  if (order.undoes) {
    return order;
  }
  TourEdit& edit = order.edit;
  edit.kind = static_cast<TourEdit::Kind>(action);
  edit.name = object.contains("name") ? text(object, "name") : "";
  edit.before = object.contains("before") ? text(object, "before") : "";
  if (edit.kind == TourEdit::Kind::kSet) {
    edit.tour = read_tour(part(object, "tour"));
  } else if (edit.name.empty()) {
    throw RequestError("name: must be that of the tour that is meant");
  }
  return order;
}

std::string tours_json(const std::vector<Tour>& tours) {
  Json json = Json::array();
  for (const Tour& tour : tours) {
    json.push_back(json_of(tour));
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace luminav
