#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/viewer/building/building_changes.hpp"
#include "services/viewer/building/building_order.hpp"

namespace luminav {

/// Somebody else has changed the building since: the message says so.
class StaleVersion : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// People's edits of zones and places. Each names the version that it was made for: a newer one is never overwritten.
/// Checking a building takes a second, for which no thread may wait that passes a STOP on: a thread of its own does it,
/// one edit after the other. Thread-safe.
class BuildingDesk {
 public:
  /// Reads the file. Throws ConfigurationError or std::runtime_error.
  explicit BuildingDesk(const std::filesystem::path& file);
  ~BuildingDesk();
  BuildingDesk(const BuildingDesk&) = delete;
  BuildingDesk& operator=(const BuildingDesk&) = delete;

  /// As it is now.
  [[nodiscard]] std::shared_ptr<const Building> building() const;
  /// Takes an edit and returns its id; what becomes of it is in `json`. Throws RequestError, or StaleVersion.
  std::int64_t order(BuildingOrder order, std::int64_t now);
  /// From now on edits are refused with this sentence; "" = no longer.
  void object(std::string why);
  /// Somebody has changed the file: reads it again.
  void read_again();
  /// True once after the file was changed by an order.
  bool take_news();
  /// {"version", "zones", "places", "undo", "objection", "orders": what became of the last ones}, with the zones that
  /// are in force at a time of day.
  [[nodiscard]] std::string json(const LocalTime& now) const;

 private:
  struct Pending {
    BuildingOrder order;
    std::int64_t id = 0;
  };
  struct Outcome {
    std::int64_t id = 0;
    BuildingOutcome what;
  };
  void work();

  BuildingChanges changes_;   // of the file, by the working thread alone
  std::mutex reading_;        // that what is read last is kept last
  mutable std::mutex mutex_;  // of what follows
  std::condition_variable has_work_;
  std::shared_ptr<const Building> building_ = std::make_shared<const Building>();
  std::string version_;
  std::string undo_;  // name of the file that an undo would bring back; "" = none
  std::string objection_;
  std::deque<Pending> pending_;
  std::deque<Outcome> outcomes_;  // of the last orders, the newest last
  std::int64_t last_id_ = 0;
  bool has_news_ = false;
  bool is_ending_ = false;
  std::thread thread_;  // last: it works on all the rest
};

}  // namespace luminav
