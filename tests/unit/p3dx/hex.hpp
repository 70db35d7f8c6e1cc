#pragma once

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace luminav {

/// "FA FB 03" -> bytes.
inline std::vector<std::uint8_t> hex(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::uint8_t> bytes;
  for (int value = 0; in >> std::hex >> value;) {
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  return bytes;
}

}  // namespace luminav
