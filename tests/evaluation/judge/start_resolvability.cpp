#include "tests/evaluation/judge/start_resolvability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {
namespace {

constexpr double kNearEnough = 0.75;  // [m] from the start to the next place: it may stand nearer to a wall

/// What an audit depends on. A mission's zones, places and doors are no part of it: two hundred of them share the
/// ceilings of eight buildings.
std::string audit_key(const Building& building, const std::filesystem::path& robot_file) {
  std::string key = fmt::format("{} {} {}", robot_file.string(), building.map_file, building.ceiling_height);
  for (const Fixture& fixture : building.fixtures) {
    const Pose2& pose = fixture.world_from_fixture;
    key += fmt::format(" {} {} {} {} {} {} {} {} {};", fixture.id, static_cast<int>(fixture.shape), pose.x, pose.y,
                       pose.theta, fixture.length, fixture.width, fixture.height, fixture.lamps);
  }
  return key;
}

}  // namespace

double StartResolvability::distance(const std::filesystem::path& building_file, const std::filesystem::path& robot_file,
                                    const Eigen::Vector2d& start) {
  const Building building = read_building(building_file);
  Audit* audit = nullptr;
  {
    const std::lock_guard lock(mutex_);
    audit = &audits_[audit_key(building, robot_file)];
  }
  // outside of the lock: who asks for another ceiling need not wait
  std::call_once(audit->is_made, [&] {
    const PriorMap walls = building.map_file.empty() ? PriorMap{} : read_map(building.map_file);
    audit->floor.emplace(building, walls, read_robot(robot_file).camera);
  });
  const std::vector<Eigen::Vector2d>& points = audit->floor->ground().points;
  const auto nearest = std::min_element(
      points.begin(), points.end(),
      [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return (a - start).norm() < (b - start).norm(); });
  return nearest == points.end() || (*nearest - start).norm() > kNearEnough
             ? -1.0
             : StartAudit(*audit->floor).at(static_cast<std::int32_t>(nearest - points.begin())).distance;
}

}  // namespace luminav
