#pragma once

#include <string>

namespace luminav::launcher {

/// $LUMINAV_PROCMAN_URL, else a port of its own that does not leave the machine: whoever reaches it gives orders.
std::string default_procman_url();

/// Makes memory run out at half a gigabyte: a damaged message that claims millions of entries is then dropped like any
/// other instead of filling the machine.
void limit_memory();

}  // namespace luminav::launcher
