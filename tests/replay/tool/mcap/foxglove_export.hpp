#pragma once

#include <cstdint>
#include <luminav/odometry_t.hpp>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/log/log_file.hpp"
#include "tests/replay/tool/mcap/message_sink.hpp"

namespace luminav {

/// Turns the events of a log, or of a running robot, into what viewers know that have Foxglove's schemas (Foxglove,
/// Lichtblick, PlotJuggler):
///
/// - /pose, PoseInFrame in "world": each POSE
/// - /tf, FrameTransforms: world -> odom with each POSE, odom -> robot with each ODOMETRY; /tf_static: robot -> camera,
/// once
/// - /sonar, PointCloud in "robot": the echoes of each SONAR
/// - /camera, CompressedImage: each CAMERA_IMAGE that is a JPEG
/// - /camera/fixtures, ImageAnnotations: the outlines of each FIXTURE_DETECTIONS
/// - /path, SceneUpdate: the line of each PATH
/// - /map, Grid: the whole map, at most once in five seconds, and at the end
/// - /log, Log: what a process says whenever it says something else
/// - CHANNEL: each message of a known type as it is, under the channel's own name
///
/// Log time is when the message was received, publish time its own stamp. Schemas: the published lists of fields.
class FoxgloveExport {
 public:
  /// `longest`: elements of an array in the messages as they are.
  FoxgloveExport(MessageSink& sink, RobotDescription robot, std::size_t longest);

  void add(const LogEvent& event);
  void finish();

  /// Messages per topic, and those of no known type per channel.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& counts() const { return counts_; }
  [[nodiscard]] const std::map<std::string, std::int64_t>& unknown() const { return unknown_; }

 private:
  void add_standard(const LogEvent& event);
  void add_pose(const LogEvent& event);
  void add_odometry(const LogEvent& event);
  void add_sonar(const LogEvent& event);
  void add_picture(const LogEvent& event);
  void add_detections(const LogEvent& event);
  void add_path(const LogEvent& event);
  void add_tile(const LogEvent& event);
  void add_map();
  /// What a process says; once for each change.
  void say(const LogEvent& event, const std::string& name, int level, const std::string& sentence);
  void write(const std::string& topic, const std::string& schema, std::int64_t received, std::int64_t utime,
             const nlohmann::json& message);
  /// Messages of one channel may be of several types.
  template <typename SchemaOf>
  MessageSink::Channel channel(const std::string& topic, const std::string& schema, SchemaOf schema_of);

  MessageSink& sink_;
  RobotDescription robot_;
  std::size_t longest_;
  std::map<std::pair<std::string, std::string>, MessageSink::Channel> channels_;  // by topic and schema
  std::map<std::string, std::uint64_t> counts_;
  std::map<std::string, std::int64_t> unknown_;
  std::map<std::string, std::string> said_;
  std::optional<odometry_t> odometry_;
  OccupancyGrid grid_;
  std::int64_t map_session_ = 0;
  std::int64_t newest_ = 0;                  // [us] received
  std::int64_t map_written_ = 0;             // [us] received; 0 = never
  std::optional<std::int64_t> map_pending_;  // [us] stamp of the newest tile that is not yet in /map
};

}  // namespace luminav
