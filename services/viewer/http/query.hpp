#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace luminav {

/// What a query, "a=1&b=2", says of a key, as it stands there; "" = nothing.
std::string_view value_of(std::string_view query, std::string_view key);

/// A value with its %20 and + read; nothing for what is no such text.
std::optional<std::string> decoded(std::string_view value);

}  // namespace luminav
