#include "services/viewer/viewer_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/tile_request_t.hpp>

#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/process/running_system.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "services/viewer/message_json.hpp"

namespace luminav {
namespace {

constexpr std::size_t kRecentPoses = 120;  // detections lag a quarter of a second at most; poses come at 10 to 50 Hz
constexpr std::int64_t kNodeForgotten = 60'000'000;  // [us] a process that was silent this long is no longer listed
constexpr std::size_t kMaxNodes = 200;
constexpr std::int32_t kLargestTile = 20'000;  // [bytes] 8192 bytes do not grow to more
constexpr int kTileRequests = 5;

bool is_jpeg(const camera_image_t& image) {
  return image.format == camera_image_t::FORMAT_JPEG && image.data.size() > 3 && image.data[0] == 0xff &&
         image.data[1] == 0xd8;
}

std::string jpeg_of(const camera_image_t& image) {
  if (is_jpeg(image)) {
    return {image.data.begin(), image.data.end()};
  }
  if (image.format != camera_image_t::FORMAT_MONO8 || image.width < 1 || image.height < 1 ||
      image.data.size() < static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    return "";
  }
  JpegEncoder encoder;
  const auto jpeg = encoder.encode({image.width, image.height, image.data}, 80);
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace

ViewerNode::ViewerNode(lcm::LCM& lcm, const ViewerConfig& config, const Clock& clock, SnapshotBoard& board,
                       PictureStore& pictures, RequestDesk& desk, Helm& helm)
    : lcm_(lcm),
      config_(config),
      clock_(clock),
      board_(board),
      pictures_(pictures),
      desk_(desk),
      helm_(helm),
      subscriber_(lcm) {
  subscriber_.on(channels::kPose, &ViewerNode::on_pose, this);
  subscriber_.on(channels::kHypotheses, &ViewerNode::on_hypotheses, this);
  subscriber_.on(channels::kNavigationStatus, &ViewerNode::on_navigation_status, this);
  subscriber_.on(channels::kControlStatus, &ViewerNode::on_control_status, this);
  subscriber_.on(channels::kPath, &ViewerNode::on_path, this);
  subscriber_.on(channels::kGridTile, &ViewerNode::on_grid_tile, this);
  subscriber_.on(channels::kJobStatus, &ViewerNode::on_job_status, this);
  subscriber_.on(channels::kSurveyStatus, &ViewerNode::on_survey_status, this);
  subscriber_.on(channels::kSonar, &ViewerNode::on_sonar, this);
  subscriber_.on(channels::kOdometry, &ViewerNode::on_odometry, this);
  subscriber_.on(channels::kRobotStatus, &ViewerNode::on_robot_status, this);
  subscriber_.on(channels::kFixtureDetections, &ViewerNode::on_fixture_detections, this);
  subscriber_.on(channels::kCameraImage, &ViewerNode::on_camera_image, this);
  subscriber_.on(channels::kNodeStatus, &ViewerNode::on_node_status, this);
  subscriber_.on(channels::kSimTruth, &ViewerNode::on_sim_truth, this);
}

void ViewerNode::heard(const char* channel, std::int64_t utime) {
  Reception& reception = receptions_[channel];
  reception.last = clock_.utime();
  ++reception.count;
  const double delay = static_cast<double>(newest_stamp_ - utime) * 1e-6;
  if (utime != 0 && newest_stamp_ != 0 && std::abs(delay) < 60.0) {
    reception.delay = reception.delay ? *reception.delay + 0.1 * (delay - *reception.delay) : delay;
  }
}

void ViewerNode::on_pose(const pose_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("POSE is not a pose");
    return;
  }
  heard(channels::kPose, message.utime);
  newest_["pose"] = to_json(message);
  desk_.on_pose(message);
  if (!recent_poses_.empty() && message.utime < recent_poses_.back().utime) {
    recent_poses_.clear();  // a replay that started again
  }
  if (!recent_poses_.empty() && message.utime == recent_poses_.back().utime) {
    recent_poses_.pop_back();  // a picture has corrected it
  }
  recent_poses_.push_back(message);
  if (recent_poses_.size() > kRecentPoses) {
    recent_poses_.pop_front();
  }
}

void ViewerNode::on_hypotheses(const hypotheses_t& message) {
  heard(channels::kHypotheses, message.utime);
  board_.put(SnapshotBoard::Lane::kLive, "hypotheses", server_sent_event("hypotheses", to_json(message)));
}

void ViewerNode::on_navigation_status(const navigation_status_t& message) {
  heard(channels::kNavigationStatus, message.utime);
  newest_["navigation"] = to_json(message);
  desk_.on_navigation_status(message);
}

void ViewerNode::on_control_status(const control_status_t& message) {
  heard(channels::kControlStatus, message.utime);
  newest_["control"] = to_json(message);
  desk_.on_control_status(message);
}

void ViewerNode::on_path(const path_t& message) {
  heard(channels::kPath, message.utime);
  board_.put(SnapshotBoard::Lane::kLive, "path", server_sent_event("path", to_json(message)));
}

void ViewerNode::on_job_status(const job_status_t& message) {
  heard(channels::kJobStatus);
  desk_.on_job_status(message);
  board_.put(SnapshotBoard::Lane::kLive, "jobs", server_sent_event("jobs", to_json(message)));
}

void ViewerNode::on_survey_status(const survey_status_t& message) {
  heard(channels::kSurveyStatus);
  desk_.on_survey_status(message);
  board_.put(SnapshotBoard::Lane::kLive, "survey", server_sent_event("survey", to_json(message)));
}

void ViewerNode::on_sonar(const sonar_t& message) {
  heard(channels::kSonar, message.utime);
  newest_["sonar"] = to_json(message);
}

void ViewerNode::on_odometry(const odometry_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("ODOMETRY is not what a robot measures");
    return;
  }
  newest_stamp_ = message.utime;
  heard(channels::kOdometry);
  newest_["odometry"] = to_json(message);
}

void ViewerNode::on_robot_status(const robot_status_t& message) {
  newest_stamp_ = message.utime;
  heard(channels::kRobotStatus);
  newest_["robot"] = to_json(message);
  desk_.on_robot_status(message);
  helm_.on_robot_status(message);
}

void ViewerNode::on_sim_truth(const sim_truth_t& message) {
  heard(channels::kSimTruth);
  newest_["truth"] = to_json(message);
}

void ViewerNode::on_node_status(const node_status_t& message) {
  heard(channels::kNodeStatus);
  const std::string name = message.process + "@" + message.host;
  if (nodes_.size() >= kMaxNodes && !nodes_.contains(name)) {
    subscriber_.drop("NODE_STATUS from more processes than can be shown");
    return;
  }
  nodes_[name] = {message, clock_.utime()};
}

void ViewerNode::on_grid_tile(const grid_tile_t& message) {
  if (!is_possible(message) || message.size < 1 || message.size > kLargestTile) {
    subscriber_.drop("GRID_TILE of an impossible size or place");
    return;
  }
  heard(channels::kGridTile);
  desk_.on_grid_tile(message);
  if (message.map_session != map_session_ || tiles_expected_ == 0) {
    map_session_ = message.map_session;
    tile_revisions_.clear();
    board_.clear(SnapshotBoard::Lane::kBulk);
    const GridGeometry geometry = geometry_of(message);
    tiles_expected_ = static_cast<std::int64_t>((geometry.columns + kTileSide - 1) / kTileSide) *
                      ((geometry.rows + kTileSide - 1) / kTileSide);
    tile_requests_left_ = kTileRequests;
  }
  const auto [known, is_new] = tile_revisions_.try_emplace({message.tile_column, message.tile_row}, message.revision);
  if (!is_new && known->second == message.revision) {
    return;  // the mapper sends all of them round-robin, for those who came late
  }
  known->second = message.revision;
  board_.put(SnapshotBoard::Lane::kBulk, fmt::format("tile {} {}", message.tile_column, message.tile_row),
             server_sent_event("tile", to_json(message)));
}

// A picture is shown together with what was found in it, so it waits for its detections; without a detector it is shown
// when the next but one is due.
void ViewerNode::on_camera_image(const camera_image_t& message) {
  heard(channels::kCameraImage, message.utime);
  if (picture_choice_.for_lamps.look(message.utime, message.exposure_us)) {
    return;
  }
  const std::int64_t since = message.utime - picture_choice_.shown_utime;
  if (since >= 0 && since < config_.picture_period) {
    return;
  }
  if (picture_ && message.utime >= picture_->utime && message.utime - picture_->utime < config_.picture_period) {
    return;  // one is waiting already
  }
  if (picture_) {
    show_picture(nullptr);
  }
  picture_ = message;
}

void ViewerNode::on_fixture_detections(const fixture_detections_t& message) {
  heard(channels::kFixtureDetections, message.utime);
  newest_["detections"] = to_json(message, world_from_robot_at(message.utime));
  if (picture_ && picture_->utime == message.utime && picture_->camera == message.camera) {
    show_picture(&message);
  }
}

void ViewerNode::show_picture(const fixture_detections_t* detections) {
  std::string jpeg = jpeg_of(*picture_);
  if (jpeg.empty()) {
    subscriber_.drop("CAMERA_IMAGE is neither JPEG nor a whole grey picture");
  } else {
    pictures_.put(picture_->sequence, std::move(jpeg));
    board_.put(SnapshotBoard::Lane::kLive, "picture",
               server_sent_event(
                   "picture", fmt::format(R"({{"utime":{},"sequence":{},"width":{},"height":{},"exposure_us":{:.0f},)"
                                          R"("health":{},"seen":{}}})",
                                          picture_->utime, picture_->sequence, picture_->width, picture_->height,
                                          std::isfinite(picture_->exposure_us) ? picture_->exposure_us : 0.0,
                                          to_json(picture_->health),
                                          detections != nullptr ? to_json(*detections, std::nullopt) : "null")));
  }
  picture_choice_.shown_utime = picture_->utime;
  picture_.reset();
}

std::optional<Pose2> ViewerNode::world_from_robot_at(std::int64_t utime) const {
  const auto after = std::lower_bound(recent_poses_.begin(), recent_poses_.end(), utime,
                                      [](const pose_t& pose, std::int64_t stamp) { return pose.utime < stamp; });
  if (recent_poses_.empty() || (after == recent_poses_.begin() && after->utime != utime)) {
    return std::nullopt;
  }
  if (after == recent_poses_.end()) {
    const pose_t& last = recent_poses_.back();
    return utime - last.utime < 500'000 ? std::optional(world_from_robot(last)) : std::nullopt;
  }
  if (after->utime == utime) {
    return world_from_robot(*after);
  }
  const pose_t& before = *std::prev(after);
  const double fraction = static_cast<double>(utime - before.utime) / static_cast<double>(after->utime - before.utime);
  return interpolate(world_from_robot(before), world_from_robot(*after), fraction);
}

std::string ViewerNode::requests_json() const {
  std::string list;
  for (const RequestDesk::State& state : desk_.states()) {
    list += fmt::format(R"({}{{"kind":"{}","fate":"{}","id":{},"objection":{},"engages":{},"age":{:.1f}}})",
                        list.empty() ? "" : ",", RequestDesk::name_of(state.kind), RequestDesk::name_of(state.fate),
                        state.id, to_json(state.objection), state.engages,
                        static_cast<double>(clock_.utime() - state.asked) * 1e-6);
  }
  return "[" + list + "]";
}

void ViewerNode::show() {
  const std::int64_t now = clock_.utime();
  std::string ages;
  for (const auto& [channel, reception] : receptions_) {
    ages += fmt::format(R"({}"{}":{:.2f})", ages.empty() ? "" : ",", channel,
                        static_cast<double>(now - reception.last) * 1e-6);
  }
  std::string state = fmt::format(R"({{"utime":{},"ages":{{{}}},"requests":{})", now, ages, requests_json());
  for (const auto& [key, json] : newest_) {
    state += fmt::format(R"(,"{}":{})", key, json);
  }
  board_.put(SnapshotBoard::Lane::kLive, "state", server_sent_event("state", state + "}"));
  board_.tick();
}

void ViewerNode::show_processes() {
  const std::int64_t now = clock_.utime();
  std::erase_if(nodes_, [&](const auto& entry) { return now - entry.second.heard > kNodeForgotten; });
  std::string rates, delays;
  for (auto& [channel, reception] : receptions_) {
    const double newest = reception.count;
    reception.rate = reception.rate == 0.0 ? newest : reception.rate + 0.3 * (newest - reception.rate);
    reception.count = 0;
    rates += fmt::format(R"({}"{}":{:.1f})", rates.empty() ? "" : ",", channel, reception.rate);
    if (reception.delay) {
      delays += fmt::format(R"({}"{}":{:.3f})", delays.empty() ? "" : ",", channel, *reception.delay);
    }
  }
  std::string nodes;
  for (const auto& [name, report] : nodes_) {
    nodes += fmt::format(R"({}{{"age":{:.1f},"status":{}}})", nodes.empty() ? "" : ",",
                         static_cast<double>(now - report.heard) * 1e-6, to_json(report.status));
  }
  board_.put(SnapshotBoard::Lane::kLive, "nodes",
             server_sent_event(
                 "nodes", fmt::format(R"({{"nodes":[{}],"rates":{{{}}},"delays":{{{}}}}})", nodes, rates, delays)));
  request_missing_tiles();
}

std::string ViewerNode::building_elsewhere(const std::string& host) const {
  constexpr std::int64_t kGone = 5'000'000;  // [us] each speaks once a second
  for (const auto& [name, report] : nodes_) {
    const node_status_t& status = report.status;
    if (status.building_hash != 0 && status.host != host && !is_onlooker(status.process) &&
        clock_.utime() - report.heard < kGone) {
      return name;
    }
  }
  return "";
}

// A viewer that comes late need not wait for the mapper's round.
void ViewerNode::request_missing_tiles() {
  if (static_cast<std::int64_t>(tile_revisions_.size()) >= tiles_expected_ || tile_requests_left_ <= 0) {
    return;
  }
  --tile_requests_left_;
  tile_request_t request{};
  request.utime = clock_.utime();
  request.id = tile_request_id_ = std::max(request.utime, tile_request_id_ + 1);
  lcm_.publish(channels::kTileRequest, &request);
}

}  // namespace luminav
