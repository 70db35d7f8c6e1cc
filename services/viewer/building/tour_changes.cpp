#include "services/viewer/building/tour_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <system_error>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/viewer/building/building_findings.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;
using Fate = EditOutcome::Fate;

constexpr int kLateness = 120;  // [s] a tour that waits longer for another one does not start that day

EditOutcome refused(std::string why) {
  return {Fate::kRefused, std::move(why)};
}

bool share_a_day(const Days& a, const Days& b) {
  for (std::size_t day = 0; day < a.size(); ++day) {
    if (a.at(day) && b.at(day)) {
      return true;
    }
  }
  return false;
}

/// Where the tour leads that check-building objects to, and who starts when it does.
std::vector<std::string> objections_to(const Tour& tour, const std::vector<Tour>& tours, const BuildingSource& site) {
  std::vector<std::string> found;
  for (const std::string& finding : findings_of(site)) {
    if (std::any_of(tour.stops.begin(), tour.stops.end(), [&](const TourStop& stop) {
          return finding.starts_with(fmt::format("place \"{}\"", stop.place));
        })) {
      found.push_back(finding);
    }
  }
  for (const Tour& other : tours) {
    if (other.name != tour.name && tour.at && other.at && std::abs(*tour.at - *other.at) < kLateness &&
        share_a_day(tour.days, other.days)) {
      found.push_back(fmt::format("the tour \"{}\" starts at {}, too: one of them waits for the other", other.name,
                                  time_of_day_text(*other.at)));
    }
  }
  return found;
}

/// What was not so before.
std::vector<std::string> new_objections(const std::vector<Tour>& before, const TourEdit& edit,
                                        const std::vector<Tour>& after, const BuildingSource& site) {
  if (edit.kind != TourEdit::Kind::kSet) {
    return {};
  }
  const auto old = std::find_if(before.begin(), before.end(), [&](const Tour& tour) { return tour.name == edit.name; });
  const std::vector<std::string> found = objections_to(edit.tour, after, site);
  return old == before.end() ? found : without(found, objections_to(*old, before, site));
}

}  // namespace

std::string TourChanges::text() const {
  return fs::exists(versions_.file()) ? versions_.read() : "";
}

std::optional<std::vector<Tour>> TourChanges::read() const {
  try {
    return read_jobs_file(versions_.file(), read_building(building_file_)).tours;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::string TourChanges::members_of(const std::vector<Tour>& tours, const LocalTime& /*now*/) {
  return fmt::format(R"("tours":{})", tours_json(tours));
}

EditOutcome TourChanges::carry_out(const TourOrder& order, std::int64_t utime) const {
  try {
    // a place that a tour needs must not go meanwhile: the folder of the building is locked first, by everybody
    const FileVersions::Lock building_lock(building_file_);
    const fs::path folder = fs::absolute(versions_.file()).parent_path();
    std::optional<FileVersions::Lock> lock;
    if (!fs::equivalent(folder, fs::absolute(building_file_).parent_path())) {
      lock.emplace(versions_.file());
    }
    return change(order, utime);
  } catch (const std::exception& error) {
    return refused(error.what());
  }
}

EditOutcome TourChanges::change(const TourOrder& order, std::int64_t utime) const {
  const BuildingSource site = read_building_source(building_file_);
  const std::string before = text();
  const JobsSource source =
      fs::exists(versions_.file()) ? read_jobs_source(versions_.file(), site.building) : JobsSource{};
  if (version_of(before) != order.version || text() != before) {
    return refused(kStale);
  }
  if (order.undoes) {
    return undo(source.jobs, site.building, utime);
  }
  const std::vector<Tour> meant = with_edit(source.jobs.tours, order.edit);
  const std::string changed = with_edit(before, source, order.edit);
  const FileVersions::Draft draft(versions_.file(), changed);
  const JobsFile after = read_jobs_source(draft.file(), site.building).jobs;
  if (!are_same_tours(after.tours, meant) || after.home != source.jobs.home ||
      after.has_charger != source.jobs.has_charger) {
    return refused("the file is written in a way that this page cannot edit: change it by hand");
  }
  if (!order.accepts) {
    if (std::vector<std::string> found = new_objections(source.jobs.tours, order.edit, meant, site); !found.empty()) {
      return {Fate::kAsks, "", std::move(found)};
    }
  }
  if (!fs::exists(versions_.file())) {
    write_whole_file(versions_.file(), "");  // that is what an undo brings back
  }
  versions_.replace(changed, utime);
  return {Fate::kDone, ""};
}

EditOutcome TourChanges::undo(const JobsFile& jobs, const Building& building, std::int64_t utime) const {
  const fs::path before = versions_.newest_before();
  if (before.empty()) {
    return refused("no earlier version lies beside the jobs file");
  }
  const JobsFile earlier = read_jobs_source(before, building).jobs;
  if (earlier.home != jobs.home || earlier.has_charger != jobs.has_charger) {
    return refused(fmt::format("the version before, {}, differs in more than tours", before.filename().string()));
  }
  versions_.undo(utime);
  return {Fate::kDone, ""};
}

}  // namespace luminav
