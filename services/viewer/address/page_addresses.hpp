#pragma once

#include <string>
#include <vector>

namespace luminav {

/// Addresses at which other machines reach a server that listens on `listen`: all IPv4 addresses of this machine's
/// cards for 0.0.0.0, else that one. A phone seldom knows a host by its name.
std::vector<std::string> reachable_addresses(const std::string& listen);

}  // namespace luminav
