#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/replay/log_reading/message_schema.hpp"

namespace luminav {

/// A message of any type as JSON, named and nested as in its .lcm file; of arrays the first `longest` elements, byte
/// arrays left out. Nothing when the bytes do not decode.
std::optional<std::string> message_json(const MessageSchemas& schemas, const std::vector<std::uint8_t>& data,
                                        std::size_t longest);

/// A JSON Schema of that, with the units.
std::string json_schema(const MessageSchemas& schemas, const TypeSchema& type);

}  // namespace luminav
