#pragma once

#include <filesystem>
#include <string>

namespace luminav {

/// `bytes` random bytes as hexadecimal digits.
std::string random_hex(std::size_t bytes);

/// Reads the token that the pages need, or makes one and keeps it, so that pages which are open stay good when the
/// viewer starts again. Only this user may read the file. Throws ConfigurationError when others may, or when it holds
/// something else, and std::runtime_error when it cannot be kept.
std::string read_or_make_token(const std::filesystem::path& file);

}  // namespace luminav
