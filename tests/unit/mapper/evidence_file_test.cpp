#include "services/mapper/evidence_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace luminav {
namespace {

OccupancyGrid some_grid() {
  OccupancyGrid grid({0.1, {1.0, -2.0}, 70, 50});
  for (std::size_t i = 0; i < grid.evidence.size(); ++i) {
    grid.evidence[i] = static_cast<std::int8_t>(i % 60 - 20);
    grid.prior[i] = i % 7 == 0 ? Prior::kOccupied : Prior::kFree;
  }
  return grid;
}

std::filesystem::path file_for(const std::string& name) {
  const auto folder = std::filesystem::path(LUMINAV_BINARY_DIR) / "unit_mapper_files";
  std::filesystem::create_directories(folder);
  return folder / name;
}

TEST(EvidenceFile, GivesBackWhatWasWritten) {
  const OccupancyGrid grid = some_grid();
  write_evidence(file_for("round.bin"), grid);
  OccupancyGrid read = grid;
  std::fill(read.evidence.begin(), read.evidence.end(), std::int8_t{0});
  ASSERT_TRUE(read_evidence(file_for("round.bin"), read));
  EXPECT_EQ(read.evidence, grid.evidence);
}

TEST(EvidenceFile, RefusesAnotherMap) {
  const OccupancyGrid grid = some_grid();
  write_evidence(file_for("other.bin"), grid);
  OccupancyGrid moved = grid;
  moved.geometry.origin.x() += 0.1;
  EXPECT_FALSE(read_evidence(file_for("other.bin"), moved));
  OccupancyGrid rebuilt = grid;
  rebuilt.prior[100] = Prior::kUnknown;
  EXPECT_FALSE(read_evidence(file_for("other.bin"), rebuilt));
}

TEST(EvidenceFile, RefusesACutOrMissingFile) {
  OccupancyGrid grid = some_grid();
  write_evidence(file_for("cut.bin"), grid);
  const auto before = grid.evidence;
  for (auto size = std::filesystem::file_size(file_for("cut.bin")); size-- > 0;) {
    std::filesystem::resize_file(file_for("cut.bin"), size);
    ASSERT_FALSE(read_evidence(file_for("cut.bin"), grid)) << size;
  }
  EXPECT_FALSE(read_evidence(file_for("missing.bin"), grid));
  EXPECT_EQ(grid.evidence, before);
}

}  // namespace
}  // namespace luminav
