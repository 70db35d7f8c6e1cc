#include "services/viewer/building/building_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <regex>
#include <set>
#include <utility>

#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;
using Fate = BuildingOutcome::Fate;

BuildingOutcome refused(std::string why) {
  return {Fate::kRefused, std::move(why)};
}

/// What check-building says, without the lines of the file that it names.
std::vector<std::string> objections_to(const BuildingSource& source, const std::optional<PriorMap>& map) {
  static const std::regex line(R"( \(line \d+\))");
  std::vector<std::string> texts;
  for (const BuildingFinding& finding : check_building(source, map ? &*map : nullptr)) {
    if (finding.kind != FindingKind::kNote) {
      texts.push_back(std::regex_replace(finding.text, line, ""));
    }
  }
  return texts;
}

std::vector<std::string> new_objections(const BuildingSource& before, const BuildingSource& after) {
  const std::string& map_file = after.building.map_file;
  const std::optional<PriorMap> map = map_file.empty() ? std::nullopt : std::optional(read_map(map_file));
  const std::vector<std::string> known = objections_to(before, map);
  std::vector<std::string> found = objections_to(after, map);
  std::erase_if(found, [&](const std::string& text) { return std::count(known.begin(), known.end(), text) > 0; });
  return found;
}

/// Names that the jobs file beside the building's cannot do without: its home, and the stops of its tours.
std::set<std::string> places_of_jobs(const fs::path& building_file) {
  std::set<std::string> names;
  const fs::path file = building_file.parent_path() / "jobs.toml";
  if (!fs::exists(file)) {
    return names;
  }
  const TomlTable root = TomlTable::load(file);
  names.insert(root.text("home", ""));
  for (const TomlTable& tour : root.tables("tour")) {
    for (const TomlTable& stop : tour.tables("stop")) {
      names.insert(stop.text("place", ""));
    }
  }
  return names;
}

/// Why a place may not go or be called otherwise; "" = it may.
std::string objection_of_jobs(const fs::path& building_file, const Building& before, const Building& after) {
  const std::set<std::string> needed = places_of_jobs(building_file);
  for (const Place& place : before.places) {
    const bool stays = std::any_of(after.places.begin(), after.places.end(),
                                   [&](const Place& other) { return other.name == place.name; });
    if (!stays && needed.contains(place.name)) {
      return fmt::format("jobs.toml beside the building's file names the place \"{}\": change it there first",
                         place.name);
    }
  }
  return "";
}

}  // namespace

std::string_view name_of(Fate fate) {
  switch (fate) {
    case Fate::kWaiting:
      return "waiting";
    case Fate::kDone:
      return "done";
    case Fate::kRefused:
      return "refused";
    case Fate::kAsks:
      return "asks";
  }
  return "";
}

std::optional<Building> BuildingChanges::read() const {
  try {
    Building building = read_building(versions_.file());
    return differ_in_zones_and_places_alone(building, begun_) ? std::optional(std::move(building)) : std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

BuildingOutcome BuildingChanges::carry_out(const BuildingOrder& order, std::int64_t utime) const {
  try {
    const FileVersions::Lock lock(versions_.file());
    const std::string text = versions_.read();
    const BuildingSource source = read_building_source(versions_.file());
    if (!differ_in_zones_and_places_alone(source.building, begun_)) {
      return refused("the file has other lamps, doors or another map by now: start the system anew first");
    }
    if (version_of(text) != order.version || versions_.read() != text) {
      return refused("somebody else has changed the building meanwhile: look at it, and save again");
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
    if (std::string why = objection_of_jobs(versions_.file(), source.building, meant); !why.empty()) {
      return refused(std::move(why));
    }
    if (!order.accepts) {
      if (std::vector<std::string> found = new_objections(source, after); !found.empty()) {
        return {Fate::kAsks, "", std::move(found)};
      }
    }
    versions_.replace(changed, utime);
    return {Fate::kDone, ""};
  } catch (const std::exception& error) {
    return refused(error.what());
  }
}

BuildingOutcome BuildingChanges::undo(const Building& building, std::int64_t utime) const {
  const fs::path before = versions_.newest_before();
  if (before.empty()) {
    return refused("no earlier version lies beside the building's file");
  }
  const Building earlier = read_building(before);
  if (!differ_in_zones_and_places_alone(earlier, building)) {
    return refused(
        fmt::format("the version before, {}, differs in more than zones and places", before.filename().string()));
  }
  if (std::string why = objection_of_jobs(versions_.file(), building, earlier); !why.empty()) {
    return refused(std::move(why));
  }
  versions_.undo(utime);
  return {Fate::kDone, ""};
}

}  // namespace luminav
