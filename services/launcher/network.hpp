#pragma once

#include <string>

namespace luminav::launcher {

/// $LUMINAV_PROCMAN_URL, else a port of its own that does not leave the machine: whoever reaches it gives orders.
std::string default_procman_url();
}  // namespace luminav::launcher
