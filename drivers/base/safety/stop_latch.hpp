#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <string>

#include "services/common/process/stop_requests.hpp"

namespace luminav {

/// The software stop. Survives a restart, a crash and a power cut when it is given a folder. A state that was kept and
/// cannot be read counts as engaged.
class StopLatch {
 public:
  /// Reads the state from `folder`/stop; "" = none is kept.
  explicit StopLatch(const std::filesystem::path& folder = {});

  /// True when the request changed the state. Touches no disk: a stop must not wait for one.
  bool request(std::int64_t id, bool engaged, const std::string& sender);
  /// Begins to write what is not kept yet, beside this thread; what fails is tried again after a second. To be called
  /// often. `now` [us] of any clock.
  void save(std::int64_t now);
  /// Waits until what save() began is done.
  void finish_saving();
  /// Why the state would not survive a restart; "" = it would.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  [[nodiscard]] bool engaged() const { return requests_.engaged(); }
  /// Id of the last request acted on; 0 = none.
  [[nodiscard]] std::int64_t id() const { return requests_.id(); }
  [[nodiscard]] const std::string& sender() const { return requests_.sender(); }

 private:
  void look_at_writing(std::int64_t now);

  std::filesystem::path file_;
  bool kept_ = true;                  // as it stands in the file, or is being written to it
  std::future<std::string> writing_;  // what went wrong
  std::int64_t retry_at_ = 0;         // [us]
  std::string trouble_;
  StopRequests requests_;
};

}  // namespace luminav
