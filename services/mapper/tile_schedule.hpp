#pragma once

#include <cstdint>
#include <deque>
#include <vector>

namespace luminav {

struct TileScheduleParams {
  double changed_period = 0.2;  ///< [s] a tile that keeps changing is sent no more often
  double round_period = 10.0;   ///< [s] within which every tile is sent once
  int burst = 50;               ///< tiles sent at one go at most, so that no receive buffer overflows
};

/// Decides which tiles go out when: requested ones first, then changed ones, then all of them in turn.
class TileSchedule {
 public:
  TileSchedule(const TileScheduleParams& params, int tiles);

  void mark_changed(int tile) { changed_[static_cast<std::size_t>(tile)] = 1; }
  void request(int tile);
  void request_all();
  /// Tiles to send at a time [us], each at most once; they count as sent.
  std::vector<int> due(std::int64_t utime);

 private:
  void send(int tile, std::int64_t utime, std::vector<int>& tiles);
  TileScheduleParams params_;
  std::vector<std::uint8_t> changed_;
  std::vector<std::uint8_t> requested_;
  std::vector<std::int64_t> sent_;  // [us] 0 = never
  std::deque<int> queue_;           // requested, in order
  std::size_t next_in_round_ = 0;
  double round_share_ = 0.0;  // tiles owed to the round
  std::int64_t last_ = 0;     // [us]
};

}  // namespace luminav
