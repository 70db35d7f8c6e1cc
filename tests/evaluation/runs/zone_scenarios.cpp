#include "tests/evaluation/runs/zone_scenarios.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>

#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/free_space.hpp"
#include "services/common/building/lane_map.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/building/standing_room.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/evaluation/judge/map_score.hpp"
#include "tests/evaluation/runs/drawn/drawn_buildings.hpp"
#include "tests/evaluation/runs/generated_worlds.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr int kFirstSeed = 1000;
constexpr int kGoals = 2;
constexpr int kTries = 200;
constexpr double kClearance = 0.5;   // [m] of starts and goals
constexpr double kBesideZone = 0.6;  // [m] nearer to a keep-out zone's edge nobody could say whether there is room
constexpr double kShortest = 3.0;    // [m] between two goals as the crow flies
// Where a robot of this radius gets to, the planner surely finds a way; where one of that gets not, it surely doesn't.
constexpr double kSurely = 0.45;  // [m]
constexpr double kHardly = 0.22;  // [m]

struct Site {
  Building building;
  PriorMap map;
  FreeSpace free;
};

std::vector<Site> read_sites(const fs::path& generated) {
  std::vector<fs::path> files;
  for (const char* name : {"laboratory", "office"}) {
    files.push_back(fs::path(LUMINAV_SOURCE_DIR) / "launch/buildings" / name / "building.toml");
  }
  for (const fs::path& drawn : make_drawn_buildings(generated)) {
    if (drawn.stem() == "old-house" || drawn.stem() == "ward" || drawn.stem() == "hotel") {
      files.push_back(drawn.parent_path() / "building.toml");
    }
  }
  for (const fs::path& world : make_worlds(generated)) {
    if (world.stem() == "w3-dense" || world.stem() == "w5-panels" || world.stem() == "w6-mixed") {
      files.push_back(world.parent_path() / "building.toml");
    }
  }
  std::vector<Site> sites;
  for (const fs::path& file : files) {
    Building building = read_building(file);
    PriorMap map = resample(read_map(building.map_file), 0.1);
    FreeSpace free(map);
    sites.push_back({std::move(building), std::move(map), std::move(free)});
  }
  return sites;
}

/// A mission while it is drawn.
class Draft {
 public:
  Draft(const Site& site, int index, int attempt)
      : site_(site),
        index_(index),
        generator_(0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(index + 1) +
                   static_cast<std::uint64_t>(attempt)) {}

  /// Nothing when what was drawn would not tell anything.
  std::optional<std::string> draw(const fs::path& home) {
    draw_zones();
    const std::optional<Eigen::Vector2d> start = draw_point();
    if (!start || is_kept_out(*start) || is_near_quiet(*start)) {
      return std::nullopt;
    }
    std::string text = fmt::format(
        "building = \"{}\"\nrobot = \"{}\"\nseed = {}\nduration = 1800\n\n[start]\nx = {:.2f}\ny = {:.2f}\n"
        "theta = {:.2f}\nknown = true\n\n[world]\ncalibrated = true\n",
        (home / "building.toml").string(), (fs::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml").string(),
        kFirstSeed + index_, start->x(), start->y(), wrap_angle(0.7 * index_));
    if (is_carried()) {
      const Eigen::Vector2d there = middle_of(zones_.front());
      if (!leads_out(there, *start)) {
        return std::nullopt;
      }
      text += fmt::format("\n[[event]]\nat = 12\nkind = \"carry\"\nx = {:.2f}\ny = {:.2f}\ntheta = {:.2f}\n", there.x(),
                          there.y(), wrap_angle(1.1 * index_));
    }
    Eigen::Vector2d last = *start;
    for (int i = 0; i < kGoals; ++i) {
      const std::optional<Goal> goal = draw_goal(last);
      if (!goal) {
        return std::nullopt;
      }
      text += fmt::format("\n[[goal]]\nx = {:.2f}\ny = {:.2f}\n{}", goal->place.x(), goal->place.y(),
                          goal->is_reachable ? "" : "expect = \"refused\"\n");
      last = goal->is_reachable ? goal->place : last;
    }
    Building building = site_.building;
    building.zones = zones_;
    fs::create_directories(home);
    write_building(home / "building.toml", building);
    return text;
  }

 private:
  struct Goal {
    Eigen::Vector2d place;
    bool is_reachable = false;
  };
  [[nodiscard]] bool is_carried() const { return index_ % 8 == 7; }
  static Eigen::Vector2d middle_of(const Zone& zone) { return 0.5 * (zone.polygon[0] + zone.polygon[2]); }

  Zone draw_zone(const std::string& name, ZoneKind kind, double length, double width) {
    // round the zone that a robot is carried into there is room: no pocket between it and a wall
    const bool is_target = is_carried() && zones_.empty();
    const Eigen::Vector2d middle = site_.free.draw_point(is_target ? 1.2 : 0.4, generator_);
    const double turn = generator_.uniform() < 0.7 ? 0.5 * kPi * std::floor(4.0 * generator_.uniform())
                                                   : kPi * (2.0 * generator_.uniform() - 1.0);
    Zone zone;
    zone.name = name;
    zone.kind = kind;
    zone.polygon = rectangle({middle.x(), middle.y(), turn}, length, width);
    zone.speed = generator_.uniform(0.1, 0.3);
    zone.direction = wrap_angle(turn);
    return zone;
  }
  void draw_zones() {
    const auto side = [&](double min, double max) { return generator_.uniform(min, max); };
    const auto add = [&](const char* name, ZoneKind kind, double length, double width) {
      zones_.push_back(draw_zone(name, kind, length, width));
    };
    zones_.clear();
    is_carried() ? add("stairs", ZoneKind::kKeepOut, 1.0, 1.0)
                 : add("stairs", ZoneKind::kKeepOut, side(0.8, 3.0), side(0.8, 2.0));
    add("exhibits", ZoneKind::kKeepOut, side(0.8, 3.0), side(0.8, 2.0));
    add("foyer", ZoneKind::kSlow, side(1.0, 5.0), side(1.0, 4.0));
    add("ward", index_ % 2 == 0 ? ZoneKind::kQuiet : ZoneKind::kSlow, side(1.0, 5.0), side(1.0, 4.0));
    add("lane", is_carried() ? ZoneKind::kSlow : ZoneKind::kOneWay, side(1.5, 5.0), side(1.5, 3.5));
    map_ = with_keep_out(site_.map, zones_);
    lanes_ = LaneMap(zones_, map_.geometry);
  }

  [[nodiscard]] bool is_kept_out(const Eigen::Vector2d& point) const {
    return find_zone(zones_, ZoneKind::kKeepOut, point) != nullptr;
  }
  /// A robot that wakes up where it is quiet and sees too little stands there until somebody tells it where it is.
  [[nodiscard]] bool is_near_quiet(const Eigen::Vector2d& point) const {
    constexpr double kWandered = 4.0;  // [m] until it knows its pose
    return std::any_of(zones_.begin(), zones_.end(), [&](const Zone& zone) {
      return zone.kind == ZoneKind::kQuiet &&
             (contains(zone.polygon, point) || distance_to_edge(zone.polygon, point) < kWandered);
    });
  }
  /// A point of which everybody agrees whether it is inside a keep-out zone.
  std::optional<Eigen::Vector2d> draw_point() {
    for (int i = 0; i < kTries; ++i) {
      const Eigen::Vector2d point = site_.free.draw_point(kClearance, generator_);
      bool is_clear = true;
      for (const Zone& zone : zones_) {
        const bool is_inside = contains(zone.polygon, point);
        const double from_edge = distance_to_edge(zone.polygon, point);
        is_clear = is_clear && (zone.kind != ZoneKind::kKeepOut || from_edge > (is_inside ? 0.1 : kBesideZone));
        // a one-way zone that begins or ends within a robot's length is left aside
        is_clear = is_clear && (zone.kind != ZoneKind::kOneWay || from_edge > kBesideZone);
      }
      if (is_clear) {
        return point;
      }
    }
    return std::nullopt;
  }
  /// Where the planner surely finds a way to, and where it perhaps does.
  struct Reach {
    std::vector<bool> surely;
    std::vector<bool> perhaps;
  };
  [[nodiscard]] Reach reach_from(const Eigen::Vector2d& from) const {
    return {reachable_cells(map_, from, kSurely, lanes_), reachable_cells(map_, from, kHardly, lanes_)};
  }
  std::optional<Goal> draw_goal(const Eigen::Vector2d& from) {
    const Reach reach = reach_from(from);
    for (int i = 0; i < kTries; ++i) {
      const std::optional<Eigen::Vector2d> place = draw_point();
      if (!place || (*place - from).norm() < kShortest) {
        continue;
      }
      const std::size_t cell = map_.geometry.index(map_.geometry.cell_at(*place));
      if (is_kept_out(*place) || reach.surely[cell] || !reach.perhaps[cell]) {
        return Goal{*place, !is_kept_out(*place) && reach.surely[cell]};
      }
    }
    return std::nullopt;
  }
  /// True if the start can be reached from wherever a robot leaves the zone in whose middle it is put: there are no
  /// lanes then.
  [[nodiscard]] bool leads_out(const Eigen::Vector2d& middle, const Eigen::Vector2d& start) const {
    const Reach reach = reach_from(start);
    bool leads = false;
    for (int i = 0; i < 16; ++i) {
      const double turn = 2.0 * kPi * i / 16;
      const Eigen::Vector2d point = middle + 1.2 * Eigen::Vector2d(std::cos(turn), std::sin(turn));
      if (map_.at(point) != Prior::kFree) {
        continue;
      }
      const std::size_t cell = map_.geometry.index(map_.geometry.cell_at(point));
      if (reach.perhaps[cell] && !reach.surely[cell]) {
        return false;
      }
      leads = leads || reach.surely[cell];
    }
    return leads;
  }

  const Site& site_;
  int index_;
  SplitMix generator_;
  std::vector<Zone> zones_;
  PriorMap map_;  // with the keep-out zones as walls
  LaneMap lanes_;
};

}  // namespace

std::vector<fs::path> make_zone_missions(const fs::path& folder) {
  const std::vector<Site> sites = read_sites(folder);
  std::vector<fs::path> scenarios;
  for (int i = 0; i < kZoneMissions; ++i) {
    const Site& site = sites[static_cast<std::size_t>(i) % sites.size()];
    const fs::path home = folder / "zones" / fmt::format("{}-{}", site.building.name, kFirstSeed + i);
    std::optional<std::string> text;
    for (int attempt = 0; attempt < kTries && !text; ++attempt) {
      text = Draft(site, i, attempt).draw(home);
    }
    if (!text) {
      throw std::runtime_error(fmt::format("zones: no mission could be drawn in {}", site.building.name));
    }
    scenarios.push_back(home / fmt::format("zones-{}.toml", kFirstSeed + i));
    write_whole_file(scenarios.back().string(), *text);
  }
  return scenarios;
}

}  // namespace luminav
