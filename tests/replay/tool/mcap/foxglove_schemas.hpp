#pragma once

#include <string>

namespace luminav {

/// The JSON Schema of a message, such as "foxglove.Log", from foxglove_schemas.json with all it refers to in it. Throws
/// std::out_of_range for a name that does not stand there.
std::string foxglove_schema(const std::string& name);

}  // namespace luminav
