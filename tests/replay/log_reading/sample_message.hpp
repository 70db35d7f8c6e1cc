#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/replay/log_reading/message_schema.hpp"

namespace luminav {

/// A message of any type on the wire, every member filled: numbers 2 (hence two elements where they count an array),
/// floating point 0.5, texts "sample". `numbers` replaces the values of integer members by their names, and nothing
/// else: what they count stays two elements.
std::vector<std::uint8_t> sample_message(const MessageSchemas& schemas, const TypeSchema& type,
                                         const std::map<std::string, std::int64_t>& numbers = {});

/// "POSE" for pose_t.
std::string sample_channel(const TypeSchema& type);

}  // namespace luminav
