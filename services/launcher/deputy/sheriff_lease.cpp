#include "services/launcher/deputy/sheriff_lease.hpp"

#include <charconv>

namespace luminav::launcher {

std::int64_t start_of_sheriff(std::string_view sheriff_id) {
  const std::size_t colon = sheriff_id.rfind(':');
  if (colon == std::string_view::npos || sheriff_id.find(':') == colon) {
    return 0;
  }
  const std::string_view digits = sheriff_id.substr(colon + 1);
  std::int64_t utime = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), utime);
  return error == std::errc() && end == digits.data() + digits.size() && utime > 0 ? utime : 0;
}

}  // namespace luminav::launcher
