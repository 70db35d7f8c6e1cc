#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace luminav {

/// Throws std::runtime_error when it cannot be read.
std::string read_whole_file(const std::filesystem::path& file);

/// Writes to a temporary file beside it that is then renamed: what was there stays whole if this ends half way. Throws
/// std::runtime_error when it cannot be written.
void write_whole_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace luminav
