#pragma once

#include <luminav/control_status_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/survey_status_t.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

// Messages as the browser gets them: SI units, names as in lcmtypes, numbers rounded to 0.1 mm and the like. A number
// that is not finite becomes null, bytes that are not UTF-8 the replacement character: what comes out always parses.

std::string to_json(const pose_t& message);
std::string to_json(const odometry_t& message);
std::string to_json(const robot_status_t& message);
std::string to_json(const control_status_t& message);
std::string to_json(const navigation_status_t& message);
std::string to_json(const node_status_t& message);
std::string to_json(const path_t& message);
std::string to_json(const sim_truth_t& message);
/// Kinds and states as words; what was asked and not done, with why.
std::string to_json(const job_status_t& message);
/// The state as a word; each fixture's covariance as [xx, xy, yy].
std::string to_json(const survey_status_t& message);
/// Ranges [m], null where nothing echoed, and the age [s] of each reading within the message.
std::string to_json(const sonar_t& message);
/// Where the robot was when the picture was taken places what is seen on the map; none = not known.
std::string to_json(const fixture_detections_t& message, const std::optional<Pose2>& world_from_robot);
/// Hypotheses as numbers; particles as base64 of six bytes each: int16 x and y [cm] little-endian relative to the first
/// hypothesis (or the first particle), int8 theta [2 pi / 256], uint8 weight (255 = the heaviest).
std::string to_json(const hypotheses_t& message);
/// The cells stay compressed as they came, in base64: the browser inflates them.
std::string to_json(const grid_tile_t& message);

/// The lists of a building's zones, with which of them are in force at a time of day, and of its places.
std::string zones_json(const Building& building, const LocalTime& now);
std::string places_json(const Building& building);

/// Building and robot.
std::string to_json(const Building& building, const RobotDescription& robot);

/// A text as JSON, with quotes.
std::string to_json(std::string_view text);

std::string to_base64(const std::uint8_t* bytes, std::size_t count);

}  // namespace luminav
