#include "services/mapper/tile_schedule.hpp"

#include <algorithm>
#include <stdexcept>

#include "services/common/geometry/seconds.hpp"

namespace luminav {

TileSchedule::TileSchedule(const TileScheduleParams& params, int tiles) : params_(params) {
  if (!(params.round_period > 0.0) || !(params.changed_period >= 0.0) || params.burst < 1) {
    throw std::invalid_argument("tile schedule: periods and burst must be above 0");
  }
  const auto count = static_cast<std::size_t>(tiles);
  changed_.assign(count, 0);
  requested_.assign(count, 0);
  sent_.assign(count, 0);
}

void TileSchedule::request(int tile) {
  std::uint8_t& requested = requested_[static_cast<std::size_t>(tile)];
  if (requested == 0) {
    requested = 1;
    queue_.push_back(tile);
  }
}

void TileSchedule::request_all() {
  for (int tile = 0; tile < static_cast<int>(requested_.size()); ++tile) {
    request(tile);
  }
}

void TileSchedule::send(int tile, std::int64_t utime, std::vector<int>& tiles) {
  const auto i = static_cast<std::size_t>(tile);
  changed_[i] = 0;
  sent_[i] = utime;
  tiles.push_back(tile);
}

std::vector<int> TileSchedule::due(std::int64_t utime) {
  std::vector<int> tiles;
  if (utime < last_) {  // a new session of the robot's clock
    last_ = utime;
    std::fill(sent_.begin(), sent_.end(), 0);
  }
  const auto burst = static_cast<std::size_t>(params_.burst);
  while (!queue_.empty() && tiles.size() < burst) {
    const int tile = queue_.front();
    queue_.pop_front();
    requested_[static_cast<std::size_t>(tile)] = 0;
    send(tile, utime, tiles);
  }
  const auto period = microseconds_of(params_.changed_period);
  for (std::size_t i = 0; i < changed_.size() && tiles.size() < 2 * burst; ++i) {
    if (changed_[i] != 0 && (sent_[i] == 0 || utime - sent_[i] >= period)) {
      send(static_cast<int>(i), utime, tiles);
    }
  }
  // a long silence is not made up for: one round is enough
  const double elapsed = last_ == 0 ? params_.round_period : seconds_between(last_, utime);
  const auto all = static_cast<double>(sent_.size());
  // a tenth faster than promised, so that the last of a round is not late by one tick
  round_share_ = std::min(round_share_ + 1.1 * all * elapsed / params_.round_period, all);
  last_ = utime;
  std::size_t steps = 0;
  while (round_share_ >= 1.0 && steps < sent_.size() && tiles.size() < 4 * burst) {
    if (sent_[next_in_round_] != utime) {
      send(static_cast<int>(next_in_round_), utime, tiles);
    }
    next_in_round_ = (next_in_round_ + 1) % sent_.size();
    round_share_ -= 1.0;
    ++steps;
  }
  return tiles;
}

}  // namespace luminav
