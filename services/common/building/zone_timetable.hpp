#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"

namespace luminav {

/// Which of a building's zones are in force, by the stamps of messages: outside its hours a zone does not exist. Until
/// the first stamp all are.
class ZoneTimetable {
 public:
  ZoneTimetable(std::vector<Zone> zones, LocalClock clock);

  /// The building's zones are these from now on.
  void set(std::vector<Zone> zones);
  /// It is that late [us]. True if other zones are in force than before.
  bool tell(std::int64_t utime);

  [[nodiscard]] const std::vector<Zone>& all() const { return all_; }
  [[nodiscard]] bool is_in_force(std::size_t zone) const { return ends_[zone].has_value(); }
  /// They know until when.
  [[nodiscard]] const std::vector<Zone>& in_force() const { return in_force_; }

 private:
  using Ends = std::vector<std::optional<std::string>>;
  [[nodiscard]] Ends ends_at(const LocalTime& now) const;
  void take(Ends ends);

  std::vector<Zone> all_;
  LocalClock clock_;
  bool has_hours_ = false;                   // any zone: else no time of day is asked for
  std::optional<std::int64_t> last_second_;  // [s] of the last stamp
  Ends ends_;                                // of each zone, "" = never; nothing: it is not in force
  std::vector<Zone> in_force_;
};

}  // namespace luminav
