#include "services/common/process/option_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace luminav {

std::optional<double> read_number(const std::string& word) {
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  const bool is_whole = !word.empty() && end == word.c_str() + word.size();
  return is_whole && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

void check_option(std::string_view flag, double value, Range range) {
  if (!(value >= range.min && value <= range.max)) {
    throw ConfigurationError(fmt::format("{} = {}, must be {} to {}", flag, value, range.min, range.max));
  }
}

void check_option(std::string_view flag, std::string_view value, std::initializer_list<std::string_view> allowed) {
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    throw ConfigurationError(fmt::format("{} = {}, must be {}", flag, value, fmt::join(allowed, " or ")));
  }
}

}  // namespace luminav
