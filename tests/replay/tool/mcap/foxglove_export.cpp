#include "tests/replay/tool/mcap/foxglove_export.hpp"

#include <openssl/evp.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <luminav/camera_image_t.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <nlohmann/json.hpp>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "tests/replay/tool/mcap/foxglove_schemas.hpp"
#include "tests/replay/tool/mcap/json_messages.hpp"

namespace luminav {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kMapPeriod = 5'000'000;      // [us]
constexpr double kLineWidth = 0.05;                 // [m] of the path
constexpr int kInfo = 2, kWarning = 3, kError = 4;  // of foxglove.Log

std::string to_base64(const std::vector<std::uint8_t>& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // it ends with a zero
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(), static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

Json time_json(std::int64_t utime) {
  return {{"sec", utime / 1'000'000}, {"nsec", utime % 1'000'000 * 1000}};
}

Json vector_json(double x, double y, double z) {
  return {{"x", x}, {"y", y}, {"z", z}};
}

Json rotation_json(double theta) {
  return {{"x", 0.0}, {"y", 0.0}, {"z", std::sin(theta / 2.0)}, {"w", std::cos(theta / 2.0)}};
}

Json pose_json(const Pose2& pose) {
  return {{"position", vector_json(pose.x, pose.y, 0.0)}, {"orientation", rotation_json(pose.theta)}};
}

Json colour(double r, double g, double b, double a = 1.0) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

Json transform_json(std::int64_t utime, const char* parent, const char* child, const Pose2& parent_from_child) {
  return {{"timestamp", time_json(utime)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", vector_json(parent_from_child.x, parent_from_child.y, 0.0)},
          {"rotation", rotation_json(parent_from_child.theta)}};
}

Json camera_transform_json(std::int64_t utime, const CameraDescription& camera) {
  Json json = transform_json(utime, "robot", "camera", {});
  const CameraMounting& mounting = camera.mounting;
  const Eigen::Quaterniond rotation(CeilingCamera(camera.intrinsics, mounting).rotation());
  json["translation"] = vector_json(mounting.x, mounting.y, mounting.z);
  json["rotation"] = {{"x", rotation.x()}, {"y", rotation.y()}, {"z", rotation.z()}, {"w", rotation.w()}};
  return json;
}

Json field_json(const char* name, int offset, int type) {
  return {{"name", name}, {"offset", offset}, {"type", type}};
}

void append(std::vector<std::uint8_t>& bytes, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

Json outline_json(const fixture_detection_t& seen, std::int64_t utime) {
  Json points = Json::array();
  for (int corner = 0; corner < 4; ++corner) {
    points.push_back({{"x", seen.corners_px[2 * corner]}, {"y", seen.corners_px[2 * corner + 1]}});
  }
  const bool is_lit = seen.state == fixture_detection_t::STATE_LIT;
  return {{"timestamp", time_json(utime)},
          {"type", 2},  // LINE_LOOP
          {"points", points},
          {"outline_color", is_lit ? colour(1.0, 0.8, 0.0) : colour(0.2, 0.6, 1.0)},
          {"outline_colors", Json::array()},
          {"fill_color", colour(0.0, 0.0, 0.0, 0.0)},
          {"thickness", 2.0},
          {"metadata", Json::array()}};
}

Json line_json(const path_t& path) {
  Json points = Json::array();
  for (std::int32_t i = 0; i < path.count; ++i) {
    points.push_back(vector_json(path.x[static_cast<std::size_t>(i)], path.y[static_cast<std::size_t>(i)], 0.0));
  }
  return {{"type", 0},  // LINE_STRIP
          {"pose", pose_json({})},
          {"thickness", kLineWidth},
          {"scale_invariant", false},
          {"points", points},
          {"color", colour(0.1, 0.7, 0.3)},
          {"colors", Json::array()},
          {"indices", Json::array()}};
}

/// What the planner would make of a cell: -1 unknown, 0 free, 100 occupied, as in ROS.
std::int8_t occupancy(const OccupancyGrid& grid, std::size_t index) {
  constexpr std::int8_t kOccupied = 16;  // log-odds 0.8
  const Prior prior = grid.prior[index];
  if (prior == Prior::kOccupied || prior == Prior::kDisputed || grid.evidence[index] > kOccupied) {
    return 100;
  }
  return prior == Prior::kFree || grid.evidence[index] < 0 ? 0 : -1;
}

}  // namespace

FoxgloveExport::FoxgloveExport(MessageSink& sink, RobotDescription robot, std::size_t longest)
    : sink_(sink), robot_(std::move(robot)), longest_(longest) {}

template <typename SchemaOf>
MessageSink::Channel FoxgloveExport::channel(const std::string& topic, const std::string& schema, SchemaOf schema_of) {
  const auto known = channels_.find({topic, schema});
  if (known != channels_.end()) {
    return known->second;
  }
  return channels_[{topic, schema}] = sink_.add_channel(topic, schema, schema_of());
}

void FoxgloveExport::write(const std::string& topic, const std::string& schema, std::int64_t received,
                           std::int64_t utime, const Json& message) {
  const MessageSink::Channel target = channel(topic, schema, [&] { return foxglove_schema(schema); });
  ++counts_[topic];
  sink_.write(target, static_cast<std::uint64_t>(received) * 1000, static_cast<std::uint64_t>(utime) * 1000,
              message.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void FoxgloveExport::add(const LogEvent& event) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  const TypeSchema* type = schemas.find(event.fingerprint());
  const std::optional<std::string> json =
      type == nullptr || event.utime < 0 ? std::nullopt : message_json(schemas, event.data, longest_);
  if (!json) {
    ++unknown_[event.channel];
    return;
  }
  const MessageSink::Channel target =
      channel(event.channel, type->package + "." + type->name, [&] { return json_schema(schemas, *type); });
  const std::int64_t stamp = schemas.integer(event.data, "utime").value_or(0);
  ++counts_[event.channel];
  sink_.write(target, static_cast<std::uint64_t>(event.utime) * 1000,
              static_cast<std::uint64_t>(stamp > 0 ? stamp : event.utime) * 1000, *json);
  if (stamp > 0) {
    add_standard(event);
  }
}

void FoxgloveExport::add_standard(const LogEvent& event) {
  using Handler = void (FoxgloveExport::*)(const LogEvent&);
  static const std::map<std::string, Handler> handlers = {
      {channels::kPose, &FoxgloveExport::add_pose},
      {channels::kOdometry, &FoxgloveExport::add_odometry},
      {channels::kSonar, &FoxgloveExport::add_sonar},
      {channels::kCameraImage, &FoxgloveExport::add_picture},
      {channels::kFixtureDetections, &FoxgloveExport::add_detections},
      {channels::kPath, &FoxgloveExport::add_path},
      {channels::kGridTile, &FoxgloveExport::add_tile}};
  if (const auto handler = handlers.find(event.channel); handler != handlers.end()) {
    (this->*handler->second)(event);
  }
  if (const auto node = decoded<node_status_t>(event.data)) {
    const int level = node->state == node_status_t::STATE_FAULT      ? kError
                      : node->state == node_status_t::STATE_DEGRADED ? kWarning
                                                                     : kInfo;
    say(event, node->process, level, node->reason.empty() && level == kInfo ? "ready" : node->reason);
  } else if (const auto navigation = decoded<navigation_status_t>(event.data)) {
    say(event, "planner", kInfo, navigation->cause);
  } else if (const auto control = decoded<control_status_t>(event.data)) {
    say(event, "controller", kInfo, control->reason);
  } else if (const auto status = decoded<robot_status_t>(event.data)) {
    say(event, "p3dx", kWarning, status->reason);
  } else if (const auto pose = decoded<pose_t>(event.data)) {
    say(event, "localizer", pose->state == pose_t::STATE_TRACKING ? kInfo : kWarning, pose->reason);
  }
  newest_ = event.utime;
  if (map_pending_ && event.utime - map_written_ >= kMapPeriod) {
    add_map();
  }
}

void FoxgloveExport::say(const LogEvent& event, const std::string& name, int level, const std::string& sentence) {
  const auto [said, is_new] = said_.try_emplace(name + "@" + event.channel);
  if (sentence.empty() || said->second == sentence) {
    return;
  }
  said->second = sentence;
  write("/log", "foxglove.Log", event.utime, event.utime,
        {{"timestamp", time_json(event.utime)},
         {"level", level},
         {"message", sentence},
         {"name", name},
         {"file", ""},
         {"line", 0}});
}

void FoxgloveExport::add_pose(const LogEvent& event) {
  const auto pose = decoded<pose_t>(event.data);
  if (!pose || !is_possible(*pose)) {
    return;
  }
  write("/pose", "foxglove.PoseInFrame", event.utime, pose->utime,
        {{"timestamp", time_json(pose->utime)}, {"frame_id", "world"}, {"pose", pose_json(world_from_robot(*pose))}});
  if (odometry_) {
    const Pose2 odom_from_robot{odometry_->x, odometry_->y, odometry_->theta};
    const Json transform =
        transform_json(pose->utime, "world", "odom", world_from_robot(*pose) * odom_from_robot.inverse());
    write("/tf", "foxglove.FrameTransforms", event.utime, pose->utime, {{"transforms", {transform}}});
  }
}

void FoxgloveExport::add_odometry(const LogEvent& event) {
  const auto odometry = decoded<odometry_t>(event.data);
  if (!odometry || !is_possible(*odometry)) {
    return;
  }
  const auto put = [&](const char* topic, const Json& transform) {
    write(topic, "foxglove.FrameTransforms", event.utime, odometry->utime, {{"transforms", {transform}}});
  };
  if (!odometry_) {
    put("/tf_static", camera_transform_json(odometry->utime, robot_.camera));
  }
  odometry_ = odometry;
  put("/tf", transform_json(odometry->utime, "odom", "robot", {odometry->x, odometry->y, odometry->theta}));
}

void FoxgloveExport::add_sonar(const LogEvent& event) {
  const auto sonar = decoded<sonar_t>(event.data);
  if (!sonar) {
    return;
  }
  std::vector<std::uint8_t> points;
  const auto discs = std::min(robot_.sonar.robot_from_sonar.size(), sonar->range.size());
  for (std::size_t i = 0; i < discs; ++i) {
    if (sonar->has_echo[i] != 0 && sonar->range_utime[i] > 0) {
      const Pose2 echo = robot_.sonar.robot_from_sonar[i] * Pose2{sonar->range[i], 0.0, 0.0};
      append(points, static_cast<float>(echo.x));
      append(points, static_cast<float>(echo.y));
      append(points, 0.0F);
    }
  }
  constexpr int kFloat32 = 7;
  write("/sonar", "foxglove.PointCloud", event.utime, sonar->utime,
        {{"timestamp", time_json(sonar->utime)},
         {"frame_id", "robot"},
         {"pose", pose_json({})},
         {"point_stride", 12},
         {"fields", {field_json("x", 0, kFloat32), field_json("y", 4, kFloat32), field_json("z", 8, kFloat32)}},
         {"data", to_base64(points)}});
}

void FoxgloveExport::add_picture(const LogEvent& event) {
  const auto image = decoded<camera_image_t>(event.data);
  if (!image || image->format != camera_image_t::FORMAT_JPEG) {
    return;
  }
  write("/camera", "foxglove.CompressedImage", event.utime, image->utime,
        {{"timestamp", time_json(image->utime)},
         {"frame_id", "camera"},
         {"data", to_base64(image->data)},
         {"format", "jpeg"}});
}

void FoxgloveExport::add_detections(const LogEvent& event) {
  const auto detections = decoded<fixture_detections_t>(event.data);
  if (!detections) {
    return;
  }
  Json outlines = Json::array();
  for (const fixture_detection_t& seen : detections->detections) {
    outlines.push_back(outline_json(seen, detections->utime));
  }
  write("/camera/fixtures", "foxglove.ImageAnnotations", event.utime, detections->utime,
        {{"circles", Json::array()}, {"points", outlines}, {"texts", Json::array()}});
}

void FoxgloveExport::add_path(const LogEvent& event) {
  const auto path = decoded<path_t>(event.data);
  if (!path) {
    return;
  }
  Json entity = {{"timestamp", time_json(path->utime)},
                 {"frame_id", "world"},
                 {"id", "path"},
                 {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                 {"frame_locked", false},
                 {"metadata", Json::array()},
                 {"lines", {line_json(*path)}}};
  for (const char* kind : {"arrows", "cubes", "spheres", "cylinders", "triangles", "texts", "models"}) {
    entity[kind] = Json::array();
  }
  write("/path", "foxglove.SceneUpdate", event.utime, path->utime,
        {{"deletions", Json::array()}, {"entities", {entity}}});
}

void FoxgloveExport::add_tile(const LogEvent& event) {
  const auto tile = decoded<grid_tile_t>(event.data);
  if (!tile || !is_possible(*tile)) {
    return;
  }
  if (tile->map_session != map_session_ || grid_.geometry != geometry_of(*tile)) {
    map_session_ = tile->map_session;
    grid_ = OccupancyGrid(geometry_of(*tile));
  }
  if (apply_tile(*tile, grid_)) {
    map_pending_ = tile->utime;
    map_written_ = map_written_ == 0 ? event.utime : map_written_;  // the first tiles come in a burst
  }
}

void FoxgloveExport::add_map() {
  const std::int64_t utime = *map_pending_;
  std::vector<std::uint8_t> cells;
  for (std::size_t i = 0; i < grid_.geometry.size(); ++i) {
    cells.push_back(static_cast<std::uint8_t>(occupancy(grid_, i)));
  }
  const GridGeometry& geometry = grid_.geometry;
  constexpr int kInt8 = 2;
  write("/map", "foxglove.Grid", newest_, utime,
        {{"timestamp", time_json(utime)},
         {"frame_id", "world"},
         {"pose", pose_json({geometry.origin.x(), geometry.origin.y(), 0.0})},
         {"column_count", geometry.columns},
         {"cell_size", {{"x", geometry.resolution}, {"y", geometry.resolution}}},
         {"row_stride", geometry.columns},
         {"cell_stride", 1},
         {"fields", {field_json("occupancy", 0, kInt8)}},
         {"data", to_base64(cells)}});
  map_written_ = newest_;
  map_pending_.reset();
}

void FoxgloveExport::finish() {
  if (map_pending_) {
    add_map();
  }
}

}  // namespace luminav
