#include "services/common/configuration/shipped_file.hpp"

#include <system_error>

namespace luminav {

std::string shipped_file(const std::filesystem::path& name) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (int level = 0; level < 5 && !folder.empty(); ++level, folder = folder.parent_path()) {
    for (const std::filesystem::path& root : {folder / "launch", folder / "share" / "luminav"}) {
      if (std::filesystem::exists(root / name, error)) {
        return (root / name).string();
      }
    }
  }
  return "";
}

}  // namespace luminav
