#include "tests/evaluation/report/output_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {

namespace fs = std::filesystem;

void check_writable(const std::string& flag, const std::string& path) {
  if (path.empty()) {
    return;
  }
  if (is_written_in_place(path)) {
    if (path != "-" && access(path.c_str(), W_OK) != 0) {
      throw ConfigurationError(fmt::format("{} {}: cannot be written", flag, path));
    }
    return;
  }
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) {
    throw ConfigurationError(fmt::format("{} {}: there is no folder {}", flag, path, folder.string()));
  }
  if (fs::is_directory(path) || access(folder.c_str(), W_OK) != 0) {
    throw ConfigurationError(fmt::format("{} {}: cannot be written", flag, path));
  }
}

}  // namespace luminav
