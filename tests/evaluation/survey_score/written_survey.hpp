#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "tests/evaluation/survey_score/survey_score.hpp"

namespace luminav {

/// A survey as it lies in its folder.
struct WrittenFolder {
  Building building;
  PriorMap map;
  std::vector<ScoredFixture> fixtures;
  Pose2 begin;                   // where the drive began, in the survey's world
  std::int64_t begin_utime = 0;  // [us]
};

/// Reads building.toml and its map, and the figures that were written as JSON. Throws std::runtime_error.
WrittenFolder read_written_survey(const std::filesystem::path& building_file, const std::filesystem::path& json_file);

}  // namespace luminav
