#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {

/// The finite number that the whole word says; nothing for any other word.
[[nodiscard]] std::optional<double> read_number(const std::string& word);

// What a person gave to an option; throw ConfigurationError naming the option, the value and what is allowed.
void check_option(std::string_view flag, double value, Range range);
void check_option(std::string_view flag, std::string_view value, std::initializer_list<std::string_view> allowed);

}  // namespace luminav
