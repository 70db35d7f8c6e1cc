#pragma once

#include <filesystem>
#include <string>

namespace luminav {

/// A file of `launch/`, such as "robots/p3dx.toml", that comes with the project or was installed with it, found from
/// the program's own place; "" when it is not there.
[[nodiscard]] std::string shipped_file(const std::filesystem::path& name);

}  // namespace luminav
