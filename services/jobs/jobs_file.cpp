#include "services/jobs/jobs_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

bool is_place(const JobSite& site, const std::string& name) {
  return std::any_of(site.places.begin(), site.places.end(), [&](const Place& place) { return place.name == name; });
}

JobStop read_stop(const TomlTable& table, const JobSite& site) {
  JobStop stop;
  stop.place = table.text("place");
  if (!is_place(site, stop.place)) {
    table.fail("place", fmt::format("{} has no place \"{}\"", site.building, stop.place));
  }
  stop.pause = table.number("pause", 0.0, {0.0, 3600.0});
  stop.text = table.text("text", "");
  if (stop.text.size() > 200) {
    table.fail("text", "must be 200 bytes at most");
  }
  table.reject_unknown();
  return stop;
}

StoredTour read_tour(const TomlTable& table, const JobSite& site) {
  StoredTour tour;
  tour.name = table.text("name");
  if (table.has("at")) {
    tour.at = read_time_of_day(table.text("at"));
    if (!tour.at) {
      table.fail("at", "must be a time of day as 09:30");
    }
  }
  if (table.has("days")) {
    const auto days = read_days(table.text("days"));
    if (!days) {
      table.fail("days", "must be days as Mo-Fr or Tu,Sa");
    }
    tour.days = *days;
  }
  for (const TomlTable& stop : table.tables("stop")) {
    tour.stops.push_back(read_stop(stop, site));
  }
  if (tour.stops.empty() || tour.stops.size() > 20) {
    table.fail("stop", "a tour has 1 to 20 [[tour.stop]]");
  }
  table.reject_unknown();
  return tour;
}

}  // namespace

void read_jobs_file(const std::filesystem::path& file, JobSite& site) {
  const TomlTable root = TomlTable::load(file);
  site.home = root.text("home", "");
  if (!site.home.empty() && !is_place(site, site.home)) {
    root.fail("home", fmt::format("{} has no place \"{}\"", site.building, site.home));
  }
  site.has_charger = root.boolean("charger", false);
  for (const TomlTable& table : root.tables("tour")) {
    StoredTour tour = read_tour(table, site);
    if (std::any_of(site.tours.begin(), site.tours.end(), [&](const StoredTour& t) { return t.name == tour.name; })) {
      table.fail("name", fmt::format("there are two tours \"{}\"", tour.name));
    }
    site.tours.push_back(std::move(tour));
  }
  root.reject_unknown();
}

}  // namespace luminav
