#include "services/launcher/network.hpp"

#include <cstdlib>

namespace luminav::launcher {

std::string default_procman_url() {
  const char* url = std::getenv("LUMINAV_PROCMAN_URL");
  return url != nullptr && *url != '\0' ? url : "udpm://239.255.76.67:7668?ttl=0";
}

}  // namespace luminav::launcher
