#include "services/jobs/jobs_config.hpp"

#include <memory>
#include <utility>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/tours/jobs_file.hpp"

namespace luminav {
namespace {

void read_params(const TomlTable& table, JobParams& params) {
  table.read("handover_timeout", params.handover_timeout, {5.0, 86400.0});
  table.read("question_timeout", params.question_timeout, {5.0, 86400.0});
  table.read("idle_time", params.idle_time, {0.0, 86400.0});
  table.read("charge_wait", params.charge_wait, {1.0, 600.0});
  table.read("charge_attempts", params.charge_attempts, {1, 10});
  BatteryParams& battery = params.battery;
  table.read("battery_low", battery.low, {6.0, 60.0});
  table.read("battery_per_metre", battery.per_metre, {0.0, 0.1});
  table.read("battery_enough", battery.enough, {6.0, 60.0});
  table.read("battery_charging", battery.charging, {6.0, 60.0});
  if (battery.enough <= battery.low || battery.charging <= battery.low) {
    table.fail("battery_low", "must be below battery_enough and battery_charging");
  }
  GuideParams& guide = params.guide;
  table.read("guide_speed", guide.speed, {0.15, 2.0});
  table.read("follower_wait", guide.wait, {1.0, 600.0});
  table.read("follower_reach", guide.follower.reach, {0.5, 5.0});
  table.read("follower_lost", guide.follower.lost_after, {0.5, 20.0});
}

}  // namespace

JobsConfig read_jobs_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file,
                            const std::filesystem::path& jobs_file) {
  const TomlTable root = TomlTable::load(robot_file);
  JobsConfig config;
  config.robot = read_robot(root);
  const TomlTable table = root.table("jobs");
  read_params(table, config.params);
  config.speech = table.choice("speech", "off", {"off", "en", "de"});
  table.reject_unknown();
  Building building = read_building(building_file);
  // one that somebody names must be there
  config.site.jobs = jobs_file.empty() ? read_jobs_file(jobs_file_of(building_file), building)
                                       : read_jobs_source(jobs_file, building).jobs;
  config.site.building = std::move(building.name);
  config.site.places = std::move(building.places);
  if (!building.map_file.empty()) {
    config.site.walls = std::make_shared<const PriorMap>(read_map(building.map_file));
  }
  return config;
}

}  // namespace luminav
