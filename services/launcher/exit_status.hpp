#pragma once

#include <cstdint>
#include <string>

namespace luminav::launcher {

// Raw wait statuses, as they travel in PM_INFO. 125 and 126 are what env and shells use for "could not run it".
inline constexpr std::int32_t kGaveUpStatus = 125 << 8;   // restarted too often in a row
inline constexpr std::int32_t kRefusedStatus = 126 << 8;  // the command does not stand in the deputy's configuration

[[nodiscard]] bool ended_well(std::int32_t status);
[[nodiscard]] bool ended_by_signal(std::int32_t status, int signal);
/// "exit 3", "killed by SIGINT", "gave up restarting it", "refused".
std::string describe_exit(std::int32_t status);

}  // namespace luminav::launcher
