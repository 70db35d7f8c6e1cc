#include "services/common/configuration/robot_base.hpp"

#include "services/common/configuration/toml_table.hpp"

namespace luminav {

std::string read_robot_base(const std::filesystem::path& robot_file) {
  return TomlTable::load(robot_file).choice("base", "p3dx", {"p3dx", "create2"});
}

}  // namespace luminav
