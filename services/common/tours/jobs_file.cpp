#include "services/common/tours/jobs_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

void check_place(const TomlTable& table, const char* key, const Building& building, const std::string& name) {
  const bool is_known = std::any_of(building.places.begin(), building.places.end(),
                                    [&](const Place& place) { return place.name == name; });
  if (!is_known) {
    table.fail(key, fmt::format("{} has no place \"{}\"", building.name, name));
  }
}

TourStop read_stop(const TomlTable& table, const Building& building) {
  TourStop stop;
  stop.place = table.text("place");
  check_place(table, "place", building, stop.place);
  stop.pause = table.number("pause", 0.0, {0.0, kLongestTourPause});
  stop.text = table.text("text", "");
  stop.photo = table.boolean("photo", false);
  if (stop.text.size() > kMaxTourText) {
    table.fail("text", fmt::format("must be {} bytes at most", kMaxTourText));
  }
  table.reject_unknown();
  return stop;
}

void read_times(const TomlTable& table, Tour& tour) {
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
}

void read_tour(const TomlTable& table, const Building& building, JobsSource& source) {
  Tour tour;
  JobsSource::TourLines lines{.tour = table.line()};
  tour.name = table.text("name");
  const std::vector<Tour>& known = source.jobs.tours;
  if (std::any_of(known.begin(), known.end(), [&](const Tour& other) { return other.name == tour.name; })) {
    table.fail("name", fmt::format("there are two tours \"{}\"", tour.name));
  }
  read_times(table, tour);
  for (const TomlTable& stop : table.tables("stop")) {
    tour.stops.push_back(read_stop(stop, building));
    lines.stops.push_back(stop.line());
  }
  if (tour.stops.empty() || tour.stops.size() > kMaxTourStops) {
    table.fail("stop", fmt::format("a tour has 1 to {} [[tour.stop]]", kMaxTourStops));
  }
  table.reject_unknown();
  source.jobs.tours.push_back(std::move(tour));
  source.lines.push_back(std::move(lines));
}

}  // namespace

std::filesystem::path jobs_file_of(const std::filesystem::path& building_file) {
  return building_file.parent_path() / "jobs.toml";
}

JobsSource read_jobs_source(const std::filesystem::path& file, const Building& building) {
  const TomlTable root = TomlTable::load(file);
  JobsSource source;
  source.jobs.home = root.text("home", "");
  if (!source.jobs.home.empty()) {
    check_place(root, "home", building, source.jobs.home);
  }
  source.jobs.has_charger = root.boolean("charger", false);
  for (const TomlTable& table : root.tables("tour")) {
    read_tour(table, building, source);
  }
  if (source.jobs.tours.size() > kMaxTours) {
    root.fail("tour", fmt::format("a building has {} tours at most", kMaxTours));
  }
  root.reject_unknown();
  return source;
}

JobsFile read_jobs_file(const std::filesystem::path& file, const Building& building) {
  return std::filesystem::exists(file) ? read_jobs_source(file, building).jobs : JobsFile{};
}

}  // namespace luminav
