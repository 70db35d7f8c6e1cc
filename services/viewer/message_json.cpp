#include "services/viewer/message_json.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace luminav {
namespace {

using Json = nlohmann::json;

std::string write(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// 0.1 mm, 0.1 mrad: what a screen can show, at half the bytes
Json rounded(double value) {
  if (!std::isfinite(value)) {
    return nullptr;
  }
  return std::round(value * 1e4) / 1e4;
}

// vectors are only as long as the sender made them, whatever the count says
template <typename First, typename Second>
std::size_t shortest(std::int32_t count, const First& first, const Second& second) {
  return std::min({static_cast<std::size_t>(std::max(0, count)), first.size(), second.size()});
}

/// One of a list of words; "" for a number that names none.
template <typename Words>
const char* word_of(const Words& words, int number) {
  return number >= 0 && static_cast<std::size_t>(number) < words.size() ? words[static_cast<std::size_t>(number)] : "";
}

Json pose_array(const Pose2& pose) {
  return {rounded(pose.x), rounded(pose.y), rounded(pose.theta)};
}

const char* name_of(FixtureShape shape) {
  switch (shape) {
    case FixtureShape::kRectangle:
      return "rectangle";
    case FixtureShape::kSquare:
      return "square";
    case FixtureShape::kRound:
      return "round";
  }
  return "";
}

Json detection_json(const fixture_detection_t& seen, const std::optional<Pose2>& world_from_robot) {
  Json json = {{"shape", static_cast<int>(seen.shape)}, {"state", static_cast<int>(seen.state)},
               {"clipped", seen.clipped != 0},          {"fit", rounded(seen.fit)},
               {"length", rounded(seen.length)},        {"width", rounded(seen.width)},
               {"has_theta", seen.has_theta != 0}};
  Json corners = Json::array();
  for (const float corner : seen.corners_px) {
    corners.push_back(std::isfinite(corner) ? Json(std::round(static_cast<double>(corner) * 10.0) / 10.0)
                                            : Json(nullptr));
  }
  json["corners_px"] = corners;
  json["centre_px"] = {rounded(seen.centre_px[0]), rounded(seen.centre_px[1])};
  if (world_from_robot) {
    json["world"] = pose_array(*world_from_robot * Pose2{seen.x, seen.y, seen.theta});
  }
  return json;
}

}  // namespace

std::string to_base64(const std::uint8_t* bytes, std::size_t count) {
  std::string text((count + 2) / 3 * 4 + 1, '\0');  // with the NUL that OpenSSL writes behind it
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes, static_cast<int>(count));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

std::string to_json(std::string_view text) {
  return write(Json(text));
}

std::string to_json(const pose_t& message) {
  Json covariance = Json::array();
  for (const double value : message.covariance) {
    covariance.push_back(std::isfinite(value) ? Json(std::round(value * 1e6) / 1e6) : Json(nullptr));
  }
  return write({{"utime", message.utime},
                {"floor", message.floor},
                {"state", static_cast<int>(message.state)},
                {"reason", message.reason},
                {"estimator", static_cast<int>(message.estimator)},
                {"x", rounded(message.x)},
                {"y", rounded(message.y)},
                {"theta", rounded(message.theta)},
                {"covariance", covariance},
                {"distance_since_fixture", rounded(message.distance_since_fixture)},
                {"nis", message.has_nis != 0 ? rounded(message.nis) : Json(nullptr)}});
}

std::string to_json(const odometry_t& message) {
  return write({{"utime", message.utime},
                {"session", message.session},
                {"x", rounded(message.x)},
                {"y", rounded(message.y)},
                {"theta", rounded(message.theta)},
                {"linear", rounded(message.linear)},
                {"angular", rounded(message.angular)}});
}

std::string to_json(const robot_status_t& message) {
  return write({{"robot", message.robot},
                {"connected", message.connected != 0},
                {"motors_enabled", message.motors_enabled != 0},
                {"stop_engaged", message.stop_engaged != 0},
                {"stop_button", message.stop_button != 0},
                {"stall", message.stall_left != 0 || message.stall_right != 0},
                {"bumpers_front", message.bumpers_front},
                {"bumpers_rear", message.bumpers_rear},
                {"battery_voltage", rounded(message.battery_voltage)},
                {"charge_state", static_cast<int>(message.charge_state)},
                {"linear", rounded(message.linear)},
                {"angular", rounded(message.angular)},
                {"maximum_linear", rounded(message.maximum_linear)},
                {"reason", message.reason}});
}

std::string to_json(const control_status_t& message) {
  Json json = {{"state", static_cast<int>(message.state)},
               {"reason", message.reason},
               {"attractive", {rounded(message.attractive_x), rounded(message.attractive_y)}},
               {"repulsive", {rounded(message.repulsive_x), rounded(message.repulsive_y)}},
               {"clearance", rounded(message.clearance)},
               {"linear", rounded(message.linear)},
               {"angular", rounded(message.angular)},
               {"distance_left", rounded(message.distance_left)},
               {"stop_engaged", message.stop_engaged != 0}};
  if (message.has_look_ahead != 0) {
    json["look_ahead"] = {rounded(message.look_ahead_x), rounded(message.look_ahead_y)};
  }
  return write(json);
}

std::string to_json(const navigation_status_t& message) {
  Json json = {{"goal_id", message.goal_id},       {"pose_index", message.pose_index},
               {"pose_count", message.pose_count}, {"state", static_cast<int>(message.state)},
               {"cause", message.cause},           {"distance_left", rounded(message.distance_left)},
               {"replans", message.replans}};
  if (message.has_target != 0) {
    json["target"] = {rounded(message.x), rounded(message.y)};
    if (message.has_theta != 0) {
      json["target"].push_back(rounded(message.theta));
    }
  }
  return write(json);
}

std::string to_json(const node_status_t& message) {
  return write({{"process", message.process},
                {"host", message.host},
                {"state", static_cast<int>(message.state)},
                {"reason", message.reason},
                {"version", message.version},
                {"dropped_inputs", message.dropped_inputs},
                {"worst_step_us", message.worst_step_us},
                {"memory_bytes", message.memory_bytes},
                {"cpu_fraction", rounded(message.cpu_fraction)}});
}

std::string to_json(const job_status_t& message) {
  static constexpr std::array kKinds{"go", "carry", "tour", "home", "guide"};
  static constexpr std::array kStates{"queued", "driving", "at_stop", "asking", "done", "failed", "cancelled"};
  Json jobs = Json::array();
  for (const job_state_t& job : message.jobs) {
    jobs.push_back({{"id", job.id},
                    {"kind", word_of(kKinds, job.kind)},
                    {"state", word_of(kStates, job.state)},
                    {"priority", job.priority},
                    {"position", job.position},
                    {"sender", job.sender},
                    {"sentence", job.sentence},
                    {"stop", job.stop},
                    {"stops", job.stops},
                    {"waits_for", job.waits_for},
                    {"text", job.text},
                    {"question", job.question},
                    {"answers", job.answers}});
  }
  Json requests = Json::array();
  for (std::size_t i = 0; i < shortest(message.echo_count, message.echo_ids, message.objections); ++i) {
    requests.push_back({{"id", message.echo_ids[i]}, {"objection", message.objections[i]}});
  }
  return write({{"utime", message.utime}, {"jobs", jobs}, {"requests", requests}, {"tours", message.tours}});
}

std::string to_json(const survey_status_t& message) {
  static constexpr std::array kStates{"driving", "estimating", "writing", "finished", "failed"};
  static constexpr std::array kShapes{"rectangle", "square", "round"};
  Json fixtures = Json::array();
  for (const surveyed_fixture_t& fixture : message.fixtures) {
    const auto& covariance = fixture.covariance;  // finer than lengths are rounded: they are squares
    fixtures.push_back({{"shape", word_of(kShapes, fixture.shape)},
                        {"length", rounded(fixture.length)},
                        {"width", rounded(fixture.width)},
                        {"pose", pose_array({fixture.x, fixture.y, fixture.theta})},
                        {"covariance", {covariance[0], covariance[1], covariance[2]}},
                        {"provisional", fixture.is_provisional != 0},
                        {"open", fixture.is_open != 0}});
  }
  Json path = Json::array();
  for (std::size_t i = 0; i < shortest(message.path_count, message.path_x, message.path_y); ++i) {
    path.push_back({rounded(message.path_x[i]), rounded(message.path_y[i])});
  }
  Json places = Json::array();
  for (std::size_t i = 0; i < std::min(shortest(message.place_count, message.place_names, message.place_x),
                                       shortest(message.place_count, message.place_names, message.place_y));
       ++i) {
    places.push_back(
        {{"name", message.place_names[i]}, {"x", rounded(message.place_x[i])}, {"y", rounded(message.place_y[i])}});
  }
  return write({{"utime", message.utime},
                {"state", word_of(kStates, message.state)},
                {"reason", message.reason},
                {"folder", message.folder},
                {"distance", rounded(message.distance)},
                {"estimated_distance", rounded(message.estimated_distance)},
                {"pose", message.has_pose ? pose_array({message.x, message.y, message.theta}) : Json(nullptr)},
                {"fixtures", fixtures},
                {"path", path},
                {"places", places},
                {"remarks", message.remarks},
                {"exploring", message.is_exploring != 0},
                {"activity", message.exploring}});
}

std::string to_json(const path_t& message) {
  Json points = Json::array();
  const std::size_t count = shortest(message.count, message.x, message.y);
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({rounded(message.x[i]), rounded(message.y[i])});
  }
  Json json = {{"goal_id", message.goal_id},
               {"pose_index", message.pose_index},
               {"sequence", message.sequence},
               {"tolerance", rounded(message.tolerance)},
               {"points", points}};
  if (message.has_theta != 0) {
    json["theta"] = rounded(message.theta);
  }
  return write(json);
}

std::string to_json(const sim_truth_t& message) {
  Json people = Json::array();
  const std::size_t count = shortest(message.people, message.person_x, message.person_y);
  for (std::size_t i = 0; i < count; ++i) {
    people.push_back({rounded(message.person_x[i]), rounded(message.person_y[i])});
  }
  Json lamps = Json::array();
  for (const std::int8_t lamp : message.lamp_state) {
    lamps.push_back(static_cast<int>(lamp));
  }
  return write({{"session", message.session},
                {"x", rounded(message.x)},
                {"y", rounded(message.y)},
                {"theta", rounded(message.theta)},
                {"linear", rounded(message.linear)},
                {"angular", rounded(message.angular)},
                {"carried", message.carried != 0},
                {"touching", message.touching != 0},
                {"contacts", message.contacts},
                {"clearance", rounded(message.clearance)},
                {"daylight", rounded(message.daylight)},
                {"people", people},
                {"lamps", lamps}});
}

std::string to_json(const sonar_t& message) {
  Json ranges = Json::array();
  Json ages = Json::array();
  const std::size_t count = std::min({static_cast<std::size_t>(std::max(0, message.count)), message.range.size(),
                                      message.has_echo.size(), message.range_utime.size()});
  for (std::size_t i = 0; i < count; ++i) {
    const bool has_echo = message.has_echo[i] != 0 && message.range_utime[i] > 0;
    ranges.push_back(has_echo ? rounded(message.range[i]) : Json(nullptr));
    ages.push_back(rounded(static_cast<double>(message.utime - message.range_utime[i]) * 1e-6));
  }
  return write({{"utime", message.utime}, {"ranges", ranges}, {"ages", ages}});
}

std::string to_json(const fixture_detections_t& message, const std::optional<Pose2>& world_from_robot) {
  Json detections = Json::array();
  for (const fixture_detection_t& seen : message.detections) {
    detections.push_back(detection_json(seen, world_from_robot));
  }
  return write({{"utime", message.utime},
                {"sequence", message.sequence},
                {"width", message.width},
                {"height", message.height},
                {"median_grey", rounded(message.median_grey)},
                {"detections", detections}});
}

std::string to_json(const hypotheses_t& message) {
  Json hypotheses = Json::array();
  const std::size_t count = std::min({shortest(message.count, message.x, message.y), message.theta.size(),
                                      message.weight.size(), message.sigma.size()});
  for (std::size_t i = 0; i < count; ++i) {
    hypotheses.push_back({rounded(message.x[i]), rounded(message.y[i]), rounded(message.theta[i]),
                          rounded(message.weight[i]), rounded(message.sigma[i])});
  }
  const std::size_t particles =
      std::min({shortest(message.particle_count, message.particle_x, message.particle_y), message.particle_theta.size(),
                message.particle_weight.size(), std::size_t{2000}});
  const float heaviest =
      particles == 0 ? 1.0F : *std::max_element(message.particle_weight.begin(), message.particle_weight.end());
  const double origin_x = particles == 0 ? 0.0 : std::round(message.particle_x[0]);
  const double origin_y = particles == 0 ? 0.0 : std::round(message.particle_y[0]);
  std::vector<std::uint8_t> packed;
  packed.reserve(particles * 6);
  const auto push_cm = [&](double metres) {
    const auto cm = static_cast<std::int16_t>(std::lround(std::clamp(metres * 100.0, -32768.0, 32767.0)));
    packed.push_back(static_cast<std::uint8_t>(cm & 0xff));
    packed.push_back(static_cast<std::uint8_t>((cm >> 8) & 0xff));
  };
  std::size_t kept = 0;
  for (std::size_t i = 0; i < particles; ++i) {
    const double theta = message.particle_theta[i];
    const double weight = message.particle_weight[i] / (heaviest > 0.0F ? heaviest : 1.0F);
    if (!std::isfinite(message.particle_x[i] - origin_x) || !std::isfinite(message.particle_y[i] - origin_y) ||
        !std::isfinite(theta) || !std::isfinite(weight)) {
      continue;
    }
    push_cm(message.particle_x[i] - origin_x);
    push_cm(message.particle_y[i] - origin_y);
    packed.push_back(static_cast<std::uint8_t>(std::lround(wrap_angle(theta) / (2.0 * kPi) * 256.0) & 0xff));
    packed.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(weight, 0.0, 1.0) * 255.0)));
    ++kept;
  }
  return write({{"utime", message.utime},
                {"hypotheses", hypotheses},
                {"particle_count", kept},
                {"origin", {rounded(origin_x), rounded(origin_y)}},
                {"particles", to_base64(packed.data(), packed.size())}});
}

std::string to_json(const grid_tile_t& message) {
  const std::size_t size = std::min(static_cast<std::size_t>(std::max(0, message.size)), message.data.size());
  return write({{"session", message.map_session},
                {"revision", message.revision},
                {"resolution", message.resolution},
                {"origin", {message.origin_x, message.origin_y}},
                {"columns", message.columns},
                {"rows", message.rows},
                {"tile_column", message.tile_column},
                {"tile_row", message.tile_row},
                {"data", to_base64(message.data.data(), size)}});
}

namespace {

Json places_of(const Building& building) {
  Json places = Json::array();
  for (const Place& place : building.places) {
    Json item = {{"name", place.name}, {"x", place.pose.x}, {"y", place.pose.y}};
    if (place.has_theta) {
      item["theta"] = rounded(place.pose.theta);
    }
    places.push_back(item);
  }
  return places;
}

Json zones_of(const Building& building, const std::optional<LocalTime>& now) {
  Json zones = Json::array();
  for (const Zone& zone : building.zones) {
    Json item = {{"name", zone.name}, {"kind", name_of(zone.kind)}, {"polygon", Json::array()}};
    for (const Eigen::Vector2d& corner : zone.polygon) {
      item["polygon"].push_back({corner.x(), corner.y()});
    }
    if (zone.kind == ZoneKind::kSlow) {
      item["speed"] = zone.speed;
    } else if (zone.kind == ZoneKind::kOneWay) {
      item["direction"] = rounded(zone.direction);
    }
    if (const std::string span = span_text(zone.hours); !span.empty()) {
      item["hours"] = span;
    }
    if (const std::string days = days_text(zone.hours.days); !days.empty()) {
      item["days"] = days;
    }
    if (now) {
      item["in_force"] = hold(zone.hours, *now);
    }
    zones.push_back(item);
  }
  return zones;
}

}  // namespace

std::string zones_json(const Building& building, const LocalTime& now) {
  return write(zones_of(building, now));
}

std::string places_json(const Building& building) {
  return write(places_of(building));
}

std::string to_json(const Building& building, const RobotDescription& robot) {
  Json json = {{"name", building.name}, {"ceiling_height", building.ceiling_height}};
  json["fixtures"] = Json::array();
  for (const Fixture& fixture : building.fixtures) {
    json["fixtures"].push_back({{"id", fixture.id},
                                {"shape", name_of(fixture.shape)},
                                {"pose", pose_array(fixture.world_from_fixture)},
                                {"length", fixture.length},
                                {"width", fixture.width}});
  }
  json["elements"] = Json::array();
  for (const CeilingElement& element : building.elements) {
    json["elements"].push_back({{"kind", name_of(element.kind)},
                                {"pose", pose_array(element.world_from_element)},
                                {"length", element.length},
                                {"width", element.width}});
  }
  json["doors"] = Json::array();
  for (const Door& door : building.doors) {
    json["doors"].push_back({{"id", door.id}, {"pose", pose_array(door.world_from_door)}, {"width", door.width}});
  }
  json["windows"] = Json::array();
  for (const Window& window : building.windows) {
    json["windows"].push_back({{"pose", pose_array(window.world_from_window)}, {"width", window.width}});
  }
  json["places"] = places_of(building);
  json["zones"] = zones_of(building, std::nullopt);
  Json footprint = Json::array();
  for (const Eigen::Vector2d& corner : robot.footprint) {
    footprint.push_back({corner.x(), corner.y()});
  }
  Json sonars = Json::array();
  for (const Pose2& sonar : robot.sonar.robot_from_sonar) {
    sonars.push_back(pose_array(sonar));
  }
  json["robot"] = {{"name", robot.name},
                   {"footprint", footprint},
                   {"sonars", sonars},
                   {"sonar_half_angle", robot.sonar.half_angle},
                   {"sonar_maximum_range", robot.sonar.maximum_range},
                   {"maximum_linear", robot.limits.linear},
                   {"maximum_angular", robot.limits.angular}};
  return write(json);
}

}  // namespace luminav
