#pragma once

#include <cstdlib>
#include <ctime>
#include <optional>
#include <string>

namespace luminav {

/// The process's time zone for as long as it lives. Rules as "CET-1CEST,M3.5.0,M10.5.0/3" need no tables of zones.
class TimeZone {
 public:
  explicit TimeZone(const char* zone) {
    if (const char* before = std::getenv("TZ")) {
      before_ = before;
    }
    set(zone);
  }
  ~TimeZone() { set(before_ ? before_->c_str() : nullptr); }
  TimeZone(const TimeZone&) = delete;
  TimeZone& operator=(const TimeZone&) = delete;

 private:
  static void set(const char* zone) {
    zone == nullptr ? unsetenv("TZ") : setenv("TZ", zone, 1);
    tzset();
  }
  std::optional<std::string> before_;
};

}  // namespace luminav
