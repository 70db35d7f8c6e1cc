#include "services/launcher/network.hpp"

#include <sys/resource.h>

#include <cstdlib>

namespace luminav::launcher {

std::string default_procman_url() {
  const char* url = std::getenv("LUMINAV_PROCMAN_URL");
  return url != nullptr && *url != '\0' ? url : "udpm://239.255.76.67:7668?ttl=0";
}

void limit_memory() {
#ifndef __SANITIZE_ADDRESS__  // its shadow memory counts
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) == 0) {
    limit.rlim_cur = 512UL << 20;
    setrlimit(RLIMIT_DATA, &limit);
  }
#endif
}

}  // namespace luminav::launcher
