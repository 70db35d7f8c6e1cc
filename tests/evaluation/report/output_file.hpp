#pragma once

#include <string>

namespace luminav {

/// Hours of work must not end in a file that cannot be written: throws ConfigurationError, which names the flag, for a
/// path in no folder, in one that cannot be written, or of a folder. "" is no file.
void check_writable(const std::string& flag, const std::string& path);

}  // namespace luminav
