#pragma once

#include <string_view>

namespace luminav::launcher {

/// Tells systemd something ("READY=1", "WATCHDOG=1"), as sd_notify(3) does; nothing where it did not start this
/// process.
void tell_service_manager(std::string_view notice);

}  // namespace luminav::launcher
