#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "services/common/calendar/hours.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/polygon.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

enum class FixtureShape { kRectangle, kSquare, kRound };

/// Angle after which a shape looks the same [rad]; 0 = it has no orientation.
inline double symmetry_period(FixtureShape shape) {
  switch (shape) {
    case FixtureShape::kRectangle:
      return kPi;
    case FixtureShape::kSquare:
      return 0.5 * kPi;
    case FixtureShape::kRound:
      return 0.0;
  }
  return 0.0;
}

/// A light fixture on the ceiling, as the building's file has it.
struct Fixture {
  int id = 0;
  FixtureShape shape = FixtureShape::kRectangle;
  Pose2 world_from_fixture;  // centre; x along the long side
  double length = 1.2;       // [m] long side; of a round one the diameter
  double width = 0.3;        // [m] short side; of a round one the diameter
  double height = 2.8;       // [m] above the floor
  int lamps = 2;
};

enum class ElementKind { kVent, kDetector, kSpeaker, kSign };

/// As building files spell it.
inline const char* name_of(ElementKind kind) {
  switch (kind) {
    case ElementKind::kVent:
      return "vent";
    case ElementKind::kDetector:
      return "detector";
    case ElementKind::kSpeaker:
      return "speaker";
    case ElementKind::kSign:
      return "sign";
  }
  return "";
}

/// Something on the ceiling that a camera sees and that is no fixture.
struct CeilingElement {
  ElementKind kind = ElementKind::kVent;
  Pose2 world_from_element;
  double length = 0.6;  // [m] of a detector: its diameter
  double width = 0.6;   // [m]
};

struct Window {
  Pose2 world_from_window;  // theta: inward normal
  double width = 1.5;       // [m]
};

struct Door {
  int id = 0;
  Pose2 world_from_door;  // centre of the opening; theta: along the opening
  double width = 0.9;     // [m]
};

struct Place {
  std::string name;
  Pose2 pose;
  bool has_theta = false;
};

/// What a robot may do that does not know where it is: drive about by sonar, which sees no stairs and little glass,
/// look round where it is, or nothing.
enum class SearchManner { kWander, kTurn, kStand };

/// As building files spell it.
inline const char* name_of(SearchManner manner) {
  switch (manner) {
    case SearchManner::kWander:
      return "wander";
    case SearchManner::kTurn:
      return "turn";
    case SearchManner::kStand:
      return "stand";
  }
  return "";
}

/// What a robot must not enter, must pass slowly or in one direction, or where it does not wander in search of its
/// pose.
enum class ZoneKind { kKeepOut, kSlow, kOneWay, kQuiet };

/// As building files spell it.
inline const char* name_of(ZoneKind kind) {
  switch (kind) {
    case ZoneKind::kKeepOut:
      return "keep-out";
    case ZoneKind::kSlow:
      return "slow";
    case ZoneKind::kOneWay:
      return "one-way";
    case ZoneKind::kQuiet:
      return "quiet";
  }
  return "";
}

/// An area of the floor with a rule of its own, such as the head of a stair.
struct Zone {
  std::string name{};
  ZoneKind kind = ZoneKind::kKeepOut;
  Polygon polygon{};       // [m] world
  double speed = 0.2;      // [m/s] in a slow zone
  double direction = 0.0;  // [rad] world, in which a one-way zone is driven through
  Hours hours{};           // outside of which it does not exist
  std::string until{};     // of one in force: when its hours end; "" = never, or nobody has told the time
};

/// For a sentence that ends with a zone: " until 12:00".
inline std::string until_of(const Zone& zone) {
  return zone.until.empty() ? "" : " until " + zone.until;
}

/// The first zone of a kind that has a point [m, world] inside; nullptr = none.
inline const Zone* find_zone(const std::vector<Zone>& zones, ZoneKind kind, const Eigen::Vector2d& point) {
  const auto found = std::find_if(zones.begin(), zones.end(),
                                  [&](const Zone& zone) { return zone.kind == kind && contains(zone.polygon, point); });
  return found == zones.end() ? nullptr : &*found;
}

/// The direction of a one-way zone, a unit vector in the world frame.
inline Eigen::Vector2d direction_of(const Zone& zone) {
  return {std::cos(zone.direction), std::sin(zone.direction)};
}

/// What goes back by less of its length counts as straight across, which is allowed.
inline constexpr double kLaneAcross = 0.02;

/// True if a movement, of any length, goes against a one-way zone.
inline bool goes_against(const Zone& zone, const Eigen::Vector2d& movement) {
  return movement.dot(direction_of(zone)) < -kLaneAcross * movement.norm();
}

/// How well a survey knows the fixtures of the file that it wrote: RMS of their 1-sigma, which they share in part.
struct SurveyAccuracy {
  double position = 0.0;  // [m]
  double heading = 0.0;   // [rad]
};

/// What is known of a building. Poses in the world frame.
struct Building {
  std::string name;
  SearchManner search = SearchManner::kTurn;
  double ceiling_height = 2.8;             // [m]
  std::string map_file;                    // absolute path of the map's YAML; "" = none
  bool is_complete = true;                 // false: lamps hang there that are not among the fixtures
  std::optional<SurveyAccuracy> survey;    // none: somebody measured them
  std::vector<Eigen::Vector2d> seen_from;  // [m] where a survey saw the ceiling: all lamps around are fixtures
  std::vector<Fixture> fixtures;
  std::vector<CeilingElement> elements;
  std::vector<Window> windows;
  std::vector<Door> doors;
  std::vector<Place> places;
  std::vector<Zone> zones;
};

}  // namespace luminav
