#include "services/viewer/viewer_config.hpp"

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {

ViewerConfig read_viewer_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file) {
  ViewerConfig config;
  const TomlTable root = TomlTable::load(robot_file);
  config.robot = read_robot(root);
  const TomlTable table = root.table("viewer");
  const double period = table.number("picture_period", 0.5, {0.1, 60.0});  // [s]
  table.reject_unknown();
  config.picture_period = static_cast<std::int64_t>(period * 1e6);
  config.building = read_building(building_file);
  return config;
}

}  // namespace luminav
