#pragma once

#include <cstdint>
#include <luminav/node_status_t.hpp>
#include <string>

namespace luminav {

/// Who speaks in NODE_STATUS. A process that starts anew is another instance.
struct ProcessIdentity {
  std::string process;
  std::string robot;
  std::string host;
  std::int64_t instance = 0;  // [us] of the wall clock when it started

  [[nodiscard]] bool has_said(const node_status_t& status) const {
    return status.instance == instance && status.process == process;
  }
  void sign(node_status_t& status) const {
    status.process = process;
    status.robot = robot;
    status.host = host;
    status.instance = instance;
  }
};

}  // namespace luminav
