#include <gtest/gtest.h>

#include <filesystem>

#include "services/common/building/building_check.hpp"
#include "services/common/building/map_file.hpp"

namespace luminav {
namespace {

TEST(ShippedBuildings, HaveNoErrors) {
  int buildings = 0;
  for (const auto& folder :
       std::filesystem::directory_iterator(std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/buildings")) {
    const BuildingSource source = read_building_source(folder.path() / "building.toml");
    const PriorMap map = read_map(source.building.map_file);
    for (const BuildingFinding& finding : check_building(source, &map)) {
      EXPECT_NE(finding.kind, FindingKind::kError) << folder.path() << ":" << finding.line << ": " << finding.text;
    }
    ++buildings;
  }
  EXPECT_GE(buildings, 2);
}

}  // namespace
}  // namespace luminav
