#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "services/common/process/stop_requests.hpp"

namespace luminav {

/// The software stop. Survives a restart when it is given a folder.
class StopLatch {
 public:
  /// Reads the state from `folder`/stop; "" = none is kept.
  explicit StopLatch(std::filesystem::path folder = {});

  /// True when the request changed the state. Touches no disk: a stop must not wait for one.
  bool request(std::int64_t id, bool engaged, const std::string& sender);
  /// Writes what was requested since the last time, when the robot has been told.
  void save();
  [[nodiscard]] bool engaged() const { return requests_.engaged(); }
  /// Id of the last request acted on; 0 = none.
  [[nodiscard]] std::int64_t id() const { return requests_.id(); }
  [[nodiscard]] const std::string& sender() const { return requests_.sender(); }

 private:
  std::filesystem::path file_;
  bool kept_ = true;  // as it stands in the file
  StopRequests requests_;
};

}  // namespace luminav
