#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Reads a binary PGM (P5); 16-bit ones are scaled to 8 bits. False for anything else and for truncated data.
[[nodiscard]] bool read_pgm(std::span<const std::uint8_t> bytes, GreyImage& image);

/// Writes a binary PGM. Throws std::runtime_error when the file cannot be written.
void write_pgm(const std::filesystem::path& file, const GreyView& image);

}  // namespace luminav
