#include "tests/replay/replay_tracks.hpp"

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "tests/replay/replay_verdict.hpp"

namespace luminav {
namespace {

constexpr std::size_t kTrailEvery = 5;  // poses

}  // namespace

void NewestTiles::add(const std::vector<std::uint8_t>& data) {
  auto tile = decoded<grid_tile_t>(data);
  if (!tile || !is_possible(*tile)) {
    return;
  }
  if (!(geometry_of(*tile) == geometry_)) {
    geometry_ = geometry_of(*tile);
    tiles_.clear();
  }
  tiles_[{tile->tile_row, tile->tile_column}] = std::move(*tile);
}

std::optional<OccupancyGrid> NewestTiles::grid() const {
  if (tiles_.empty()) {
    return std::nullopt;
  }
  OccupancyGrid grid(geometry_);
  for (const auto& [place, tile] : tiles_) {
    [[maybe_unused]] const bool applied = apply_tile(tile, grid);
  }
  return grid;
}

void ReplayTracks::add_truth(const LogEvent& event) {
  if (const auto truth = decoded<sim_truth_t>(event.data)) {
    truth_.add(truth->utime, {truth->x, truth->y, truth->theta}, truth->carried != 0);
  }
}

void ReplayTracks::add_recorded(LogEvent event) {
  if (event.channel == channels::kPose) {
    if (const auto pose = decoded<pose_t>(event.data)) {
      recorded_.push_back(sample_of(*pose));
    }
  } else if (event.channel == channels::kGridTile) {
    recorded_tiles_.add(event.data);
  }
  report_.divergence.recorded(std::move(event));
}

void ReplayTracks::add_replayed(LogEvent event) {
  if (event.channel == channels::kPose) {
    if (const auto pose = decoded<pose_t>(event.data)) {
      replayed_.push_back(sample_of(*pose));
      odometries_.push_back(odometry_);
    }
  } else if (event.channel == channels::kGridTile) {
    tiles_.add(event.data);
  }
  report_.divergence.replayed(std::move(event));
}

void ReplayTracks::conclude(double departure) {
  ReplayReport& r = report_;
  r.divergence.finish();
  r.has_truth = !truth_.empty();
  if (!r.has_truth) {
    for (const PoseSample& sample : recorded_) {
      if (sample.state == pose_t::STATE_TRACKING) {
        truth_.add(sample.utime, sample.pose, false);
      }
    }
  }
  r.recorded = measure(recorded_, truth_);
  r.replayed = measure(replayed_, truth_);
  r.departed = first_departure(recorded_, replayed_, departure);
  r.grid = tiles_.grid();
  r.map = compare_maps(recorded_tiles_.grid(), r.grid);
  for (std::size_t i = 0; i < replayed_.size(); i += kTrailEvery) {
    const PoseSample& sample = replayed_[i];
    r.trail.push_back({truth_.at(sample.utime).value_or(r.trail.empty() ? sample.pose : r.trail.back().truth),
                       sample.pose, odometries_[i], sample.state, sample.estimator});
  }
  for (std::size_t i = 0; i < recorded_.size(); i += kTrailEvery) {
    if (recorded_[i].state == pose_t::STATE_TRACKING) {
      r.recorded_trail.push_back(recorded_[i].pose);
    }
  }
}

}  // namespace luminav
