#include "services/mapper/mapper_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "services/common/building/map_file.hpp"
#include "services/common/geometry/seconds.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/mapper/evidence_file.hpp"

namespace luminav {
namespace {

constexpr const char* kEvidenceFile = "evidence.bin";
constexpr const char* kDefaultMap = "map";
constexpr int kMaxCells = 4096;           // per axis, as GRID_TILE's receivers accept
constexpr std::size_t kMaxPending = 256;  // 16 discs x 16: half a second without POSE is not worth keeping

/// True for the name of a map: a request from the network never names a file.
bool is_map_name(const std::string& text) {
  const auto allowed = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '-' || c == '_'); };
  return text.size() <= 64 && std::all_of(text.begin(), text.end(), allowed);
}

/// Why a map cannot be one of the building whose map has the other geometry; "" when it can.
std::string misfit(const GridGeometry& map, const GridGeometry& building, double resolution) {
  const auto size = [](const GridGeometry& grid) {
    return Eigen::Vector2d(grid.columns * grid.resolution, grid.rows * grid.resolution);
  };
  if ((size(map) / resolution).maxCoeff() > kMaxCells) {
    return fmt::format("{} x {} m, must be at most {} cells of {} m along each side", size(map).x(), size(map).y(),
                       kMaxCells, resolution);
  }
  const Eigen::Vector2d low = map.origin.cwiseMax(building.origin);
  const Eigen::Vector2d high = (map.origin + size(map)).cwiseMin(building.origin + size(building));
  const Eigen::Vector2d common = (high - low).cwiseMax(0.0);
  return common.prod() >= 0.5 * size(building).prod() ? ""
                                                      : "covers less than half of the building's map: of another one?";
}

}  // namespace

MapperNode::MapperNode(lcm::LCM& lcm, const MapperConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm), config_(config), drawn_until_(config.robot.sonar.robot_from_sonar.size(), 0), subscriber_(lcm, key) {
  start_map(config.prior, 0);
  if (!config_.state_folder.empty()) {
    OccupancyGrid kept = mapper_->grid();
    if (read_evidence(config_.state_folder / kEvidenceFile, kept)) {
      (void)mapper_->restore_evidence(kept);
    }
  }
  subscriber_.on(channels::kPose, &MapperNode::on_pose, this);
  subscriber_.on(channels::kSonar, &MapperNode::on_sonar, this);
  subscriber_.on(channels::kMapCommand, &MapperNode::on_map_command, this);
  subscriber_.on(channels::kTileRequest, &MapperNode::on_tile_request, this);
}

Health MapperNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  health.degraded = !keep_error_.empty();
  health.reason = keep_error_;
  return health;
}

void MapperNode::start_map(const PriorMap& prior, std::int64_t session) {
  const int discs = std::max(1, static_cast<int>(config_.robot.sonar.robot_from_sonar.size()));
  mapper_ = std::make_unique<GridMapper>(config_.grid, prior, discs);
  const TileSender::Header before = sender_ ? sender_->header : TileSender::Header{};
  sender_.emplace(lcm_, config_.tiles, mapper_->grid().geometry);
  sender_->header = before;
  sender_->header.map_session = session;
}

bool MapperNode::is_trusted(const pose_t& pose) const {
  const double position_variance = std::max(pose.covariance[0], pose.covariance[4]);
  return pose.state == pose_t::STATE_TRACKING && position_variance <= config_.position_limit * config_.position_limit &&
         pose.covariance[8] <= config_.heading_limit * config_.heading_limit &&
         std::abs(pose.angular) <= config_.turn_limit;
}

void MapperNode::on_pose(const pose_t& pose) {
  if (!is_possible(pose) || !all_finite({pose.covariance[0], pose.covariance[4], pose.covariance[8]}) ||
      pose.utime <= 0) {
    subscriber_.drop("POSE that is none");
    return;
  }
  if (pose.utime == pose_stamps_.newest()) {
    return;  // corrected by a picture: what was heard until then is drawn
  }
  const StampGuard::Verdict verdict = pose_stamps_.check(pose.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("POSE older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession || pose.session != pose_session_) {
    poses_.clear();
    pending_.clear();
    pose_session_ = pose.session;
  }
  poses_.add({pose.utime, world_from_robot(pose), std::abs(pose.linear), is_trusted(pose)});
  draw_pending();
  mapper_->decay(pose.utime);
  send_tiles(pose.utime);
  keep_evidence(pose.utime);
}

void MapperNode::on_sonar(const sonar_t& sonar) {
  const std::size_t discs = config_.robot.sonar.robot_from_sonar.size();
  if (sonar.utime <= 0 || static_cast<std::size_t>(std::max(0, sonar.count)) != discs) {
    subscriber_.drop(fmt::format("SONAR with {} readings, the robot's file has {} discs", sonar.count, discs));
    return;
  }
  const StampGuard::Verdict verdict = sonar_stamps_.check(sonar.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("SONAR older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession) {
    std::fill(drawn_until_.begin(), drawn_until_.end(), 0);
    pending_.clear();
  }
  for (std::size_t i = 0; i < discs; ++i) {
    if (!sonar.fresh[i] || sonar.range_utime[i] <= drawn_until_[i] || sonar.range_utime[i] > sonar.utime) {
      continue;
    }
    if (!std::isfinite(sonar.range[i]) || sonar.range[i] < 0.0F) {
      subscriber_.drop(fmt::format("SONAR reading {} is no number", i));
      continue;
    }
    drawn_until_[i] = sonar.range_utime[i];
    if (sonar.session == pose_session_ || pose_session_ == 0) {
      pending_.push_back({static_cast<int>(i), sonar.range_utime[i], sonar.range[i], sonar.has_echo[i] != 0});
    }
  }
  while (pending_.size() > kMaxPending) {
    pending_.pop_front();
  }
  draw_pending();
  send_tiles(sonar.utime);
}

void MapperNode::draw_pending() {
  // readings wait for the first pose after them
  std::stable_sort(pending_.begin(), pending_.end(),
                   [](const PendingReading& a, const PendingReading& b) { return a.utime < b.utime; });
  while (!pending_.empty() && pending_.front().utime <= poses_.newest()) {
    const PendingReading reading = pending_.front();
    pending_.pop_front();
    const std::optional<Pose2> pose = poses_.trusted_at(reading.utime);
    if (!pose) {
      continue;
    }
    const Pose2& robot_from_sonar = config_.robot.sonar.robot_from_sonar[static_cast<std::size_t>(reading.disc)];
    mapper_->integrate({reading.disc, reading.utime, *pose, *pose * robot_from_sonar, reading.range, reading.has_echo});
    if (reading.disc == 0) {
      mapper_->mark_robot(*pose);
    }
    ++integrated_;
  }
}

void MapperNode::send_tiles(std::int64_t utime) {
  if (sender_->header.map_session == 0) {
    sender_->header.map_session = utime;
  }
  sender_->mark_changed(mapper_->take_touched_tiles());
  sender_->send_due(mapper_->grid(), utime);
}

void MapperNode::on_tile_request(const tile_request_t& request) {
  if (!sender_->take(request)) {
    subscriber_.drop("TILE_REQUEST of an impossible size");
    return;
  }
  // sent with the next POSE or SONAR; without either, at once
  if (poses_.newest() == 0 && request.utime > 0) {
    send_tiles(request.utime);
  }
}

void MapperNode::on_map_command(const map_command_t& command) {
  if (command.id == sender_->header.map_command_id) {
    return;  // repeated until the echo arrives
  }
  if (command.id < sender_->header.map_command_id) {
    subscriber_.drop("MAP_COMMAND from before the last one");
    return;
  }
  std::string result = carry_out(command);  // may begin another map
  TileSender::Header& header = sender_->header;
  header.map_command_result = std::move(result);
  header.map_command_id = command.id;
  const std::int64_t utime = std::max(poses_.newest(), header.map_session != 0 ? header.map_session : command.utime);
  sender_->send(mapper_->grid(), 0, utime > 0 ? utime : command.utime);
}

std::string MapperNode::carry_out(const map_command_t& command) {
  const bool needs_file = command.action == map_command_t::ACTION_SAVE || command.action == map_command_t::ACTION_LOAD;
  if (needs_file && config_.state_folder.empty()) {
    return "the mapper runs without a state folder";
  }
  if (needs_file && !is_map_name(command.path)) {
    return "a map is named by letters, digits, - and _, without a folder";
  }
  const std::filesystem::path file =
      config_.state_folder / ((command.path.empty() ? kDefaultMap : command.path) + ".yaml");
  try {
    switch (command.action) {
      case map_command_t::ACTION_SAVE:
        std::filesystem::create_directories(config_.state_folder);
        write_map(file, mapper_->combined());
        return "";
      case map_command_t::ACTION_LOAD: {
        const PriorMap map = read_map(file);
        if (const std::string why = misfit(map.geometry, config_.prior.geometry, config_.resolution); !why.empty()) {
          return fmt::format("{}: {}", file.string(), why);
        }
        start_map(resample(map, config_.resolution),
                  std::max({poses_.newest(), sender_->header.map_session, command.utime}) + 1);
        return "";
      }
      case map_command_t::ACTION_CLEAR_EVIDENCE:
        mapper_->clear_evidence();
        return "";
      default:
        return fmt::format("unknown action {}", static_cast<int>(command.action));
    }
  } catch (const std::exception& error) {
    return error.what();
  }
}

void MapperNode::keep_evidence(std::int64_t utime) {
  if (config_.state_folder.empty() || integrated_ == kept_integrated_) {
    return;
  }
  if (kept_at_ == 0 || utime < kept_at_) {
    kept_at_ = utime;
  }
  if (utime - kept_at_ < microseconds_of(config_.keep_period)) {
    return;
  }
  kept_at_ = utime;
  kept_integrated_ = integrated_;
  try {
    write_evidence(config_.state_folder / kEvidenceFile, mapper_->grid());
    keep_error_.clear();
  } catch (const std::exception& error) {
    keep_error_ = error.what();
  }
}

}  // namespace luminav
