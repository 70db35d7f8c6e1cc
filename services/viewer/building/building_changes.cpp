#include "services/viewer/building/building_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "services/common/tours/jobs_file.hpp"
#include "services/viewer/building/building_findings.hpp"
#include "services/viewer/message_json.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;
using Fate = EditOutcome::Fate;

EditOutcome refused(std::string why) {
  return {Fate::kRefused, std::move(why)};
}

/// What names a place in the jobs file, which cannot do without it: its home, or a stop of a tour; "" = nothing.
std::string user_of(const std::string& place, const fs::path& jobs_file, const Building& building) {
  const JobsFile jobs = read_jobs_file(jobs_file, building);
  for (const Tour& tour : jobs.tours) {
    for (const TourStop& stop : tour.stops) {
      if (stop.place == place) {
        return fmt::format("the tour \"{}\" stops at \"{}\"", tour.name, place);
      }
    }
  }
  return jobs.home == place ? fmt::format("{} names \"{}\" the robot's home", jobs_file.filename().string(), place)
                            : "";
}

/// Why a place may not go or be called otherwise; "" = it may.
std::string objection_of_jobs(const fs::path& jobs_file, const Building& before, const Building& after) {
  for (const Place& place : before.places) {
    const bool stays = std::any_of(after.places.begin(), after.places.end(),
                                   [&](const Place& other) { return other.name == place.name; });
    const std::string user = stays ? "" : user_of(place.name, jobs_file, before);
    if (!user.empty()) {
      return user + ": change that first";
    }
  }
  return "";
}

}  // namespace

std::optional<Building> BuildingChanges::read() const {
  try {
    Building building = read_building(versions_.file());
    return differ_in_zones_and_places_alone(building, begun_) ? std::optional(std::move(building)) : std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

EditOutcome BuildingChanges::carry_out(const BuildingOrder& order, std::int64_t utime) const {
  try {
    const FileVersions::Lock lock(versions_.file());
    const std::string text = versions_.read();
    const BuildingSource source = read_building_source(versions_.file());
    if (!differ_in_zones_and_places_alone(source.building, begun_)) {
      return refused("the file has other lamps, doors or another map by now: start the system anew first");
    }
    if (version_of(text) != order.version || versions_.read() != text) {
      return refused(kStale);
    }
    if (order.undoes) {
      return undo(source.building, utime);
    }
    const Building meant = with_edit(source.building, order.edit);
    const std::string changed = with_edit(text, source, order.edit);
    const FileVersions::Draft draft(versions_.file(), changed);
    const BuildingSource after = read_building_source(draft.file());
    if (!differ_in_zones_and_places_alone(after.building, meant) ||
        !are_same_zones(after.building.zones, meant.zones) || !are_same_places(after.building.places, meant.places)) {
      return refused("the file is written in a way that this page cannot edit: change it by hand");
    }
    if (std::string why = objection_of_jobs(jobs_file_, source.building, meant); !why.empty()) {
      return refused(std::move(why));
    }
    if (!order.accepts) {
      if (std::vector<std::string> found = without(findings_of(after), findings_of(source)); !found.empty()) {
        return {Fate::kAsks, "", std::move(found)};
      }
    }
    versions_.replace(changed, utime);
    return {Fate::kDone, ""};
  } catch (const std::exception& error) {
    return refused(error.what());
  }
}

std::string BuildingChanges::members_of(const Building& building, const LocalTime& now) {
  return fmt::format(R"("zones":{},"places":{})", zones_json(building, now), places_json(building));
}

EditOutcome BuildingChanges::undo(const Building& building, std::int64_t utime) const {
  const fs::path before = versions_.newest_before();
  if (before.empty()) {
    return refused("no earlier version lies beside the building's file");
  }
  const Building earlier = read_building(before);
  if (!differ_in_zones_and_places_alone(earlier, building)) {
    return refused(
        fmt::format("the version before, {}, differs in more than zones and places", before.filename().string()));
  }
  if (std::string why = objection_of_jobs(jobs_file_, building, earlier); !why.empty()) {
    return refused(std::move(why));
  }
  versions_.undo(utime);
  return {Fate::kDone, ""};
}

}  // namespace luminav
