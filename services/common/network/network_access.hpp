#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/command_seal.hpp"
#include "services/common/network/lcm_network.hpp"

namespace luminav {

/// Who may speak to a robot: table [network] of its file.
struct NetworkAccess {
  std::vector<std::uint32_t> peers;  // IPv4 addresses of other machines, host byte order; none = all of them
  std::optional<CommandKey> key;     // none = an open network: whoever is heard is obeyed

  [[nodiscard]] LcmNetwork on(const std::string& url) const { return {url, peers}; }
};

/// Reads table [network] of the robot's file ("" = none): `peers = ["10.0.0.2"]` and `key = "FILE"`. Where it names no
/// key, that of $LUMINAV_KEY counts, else network.key in the state folder, if it is there. Throws ConfigurationError.
NetworkAccess read_network_access(const std::filesystem::path& robot_file);
/// Who is obeyed on a network, in one plain sentence.
std::string describe(const NetworkAccess& access, const std::string& url);

}  // namespace luminav
