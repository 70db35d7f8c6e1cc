#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "services/common/calendar/local_time.hpp"
#include "services/viewer/building/building_changes.hpp"
#include "services/viewer/building/tour_changes.hpp"

namespace luminav {

/// Somebody else has changed the file since: the message says so.
class StaleVersion : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// People's edits of a file of the building. Each names the version that it was made for: a newer one is never
/// overwritten. Checking a building takes a second, for which no thread may wait that passes a STOP on: a thread of its
/// own does it, one edit after the other. Thread-safe.
///
/// `Changes` says what the file holds (Contents), what may be ordered (Order) and how it is carried out.
template <typename Changes>
class EditDesk {
 public:
  using Order = typename Changes::Order;
  using Contents = typename Changes::Contents;

  /// Reads the file. Throws what the making of `changes` threw, nothing else.
  explicit EditDesk(Changes changes);
  ~EditDesk();
  EditDesk(const EditDesk&) = delete;
  EditDesk& operator=(const EditDesk&) = delete;

  /// As it is now.
  [[nodiscard]] std::shared_ptr<const Contents> contents() const;
  /// Takes an edit and returns its id; what becomes of it is in `json`. Throws RequestError, or StaleVersion.
  std::int64_t order(Order order, std::int64_t now);
  /// From now on edits are refused with this sentence; "" = no longer.
  void object(std::string why);
  /// Somebody has changed the file: reads it again.
  void read_again();
  /// Reads it again if somebody has.
  void look();
  /// True once after the file was changed by an order.
  bool take_news();
  /// {"version", what the file holds, "undo", "objection", "orders": what became of the last ones}, with what is in
  /// force at a time of day.
  [[nodiscard]] std::string json(const LocalTime& now) const;

 private:
  struct Pending {
    Order order;
    std::int64_t id = 0;
  };
  struct Outcome {
    std::int64_t id = 0;
    EditOutcome what;
  };
  void work();

  Changes changes_;           // of the file, by the working thread alone
  std::mutex reading_;        // that what is read last is kept last
  mutable std::mutex mutex_;  // of what follows
  std::condition_variable has_work_;
  std::shared_ptr<const Contents> contents_ = std::make_shared<const Contents>();
  std::string version_;
  std::string undo_;  // name of the file that an undo would bring back; "" = none
  std::string objection_;
  decltype(std::declval<FileVersions>().stamp()) stamp_;  // of the file that was looked at last
  std::deque<Pending> pending_;
  std::deque<Outcome> outcomes_;  // of the last orders, the newest last
  std::int64_t last_id_ = 0;
  bool has_news_ = false;
  bool is_ending_ = false;
  std::thread thread_;  // last: it works on all the rest
};

/// Zones and places; tours.
using BuildingDesk = EditDesk<BuildingChanges>;
using TourDesk = EditDesk<TourChanges>;
extern template class EditDesk<BuildingChanges>;
extern template class EditDesk<TourChanges>;

}  // namespace luminav
