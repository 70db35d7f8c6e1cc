#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/replay/log_reading/message_schema.hpp"

namespace luminav {

/// A message of any type on the wire, every member filled: numbers 2 (hence two elements where they count an array),
/// floating point 0.5, texts "sample".
std::vector<std::uint8_t> sample_message(const MessageSchemas& schemas, const TypeSchema& type);

/// "POSE" for pose_t.
std::string sample_channel(const TypeSchema& type);

}  // namespace luminav
