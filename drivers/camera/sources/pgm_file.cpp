#include "drivers/camera/sources/pgm_file.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr int kLargestSide = 8192;  // [px]

/// Next number of the header, past white space and comments.
std::optional<int> next_number(std::span<const std::uint8_t> bytes, std::size_t& at) {
  while (at < bytes.size() && (std::isspace(bytes[at]) != 0 || bytes[at] == '#')) {
    if (bytes[at] == '#') {
      while (at < bytes.size() && bytes[at] != '\n') {
        ++at;
      }
    } else {
      ++at;
    }
  }
  int number = 0;
  const std::size_t begin = at;
  while (at < bytes.size() && std::isdigit(bytes[at]) != 0 && number < 1'000'000) {
    number = 10 * number + (bytes[at++] - '0');
  }
  return at == begin ? std::nullopt : std::optional(number);
}

}  // namespace

bool read_pgm(std::span<const std::uint8_t> bytes, GreyImage& image) {
  if (bytes.size() < 2 || bytes[0] != 'P' || bytes[1] != '5') {
    return false;
  }
  std::size_t at = 2;
  const auto width = next_number(bytes, at);
  const auto height = next_number(bytes, at);
  const auto max = next_number(bytes, at);
  if (!width || !height || !max || *width < 1 || *height < 1 || *width > kLargestSide || *height > kLargestSide ||
      *max < 1 || *max > 65535) {
    return false;
  }
  ++at;  // exactly one white space before the data
  const std::size_t pixels = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  const std::size_t bytes_per_pixel = *max > 255 ? 2 : 1;
  if (at > bytes.size() || bytes.size() - at < pixels * bytes_per_pixel) {
    return false;
  }
  const auto data = bytes.subspan(at);
  image.width = *width;
  image.height = *height;
  image.pixels.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const int value = bytes_per_pixel == 1 ? data[i] : 256 * data[2 * i] + data[2 * i + 1];
    image.pixels[i] = static_cast<std::uint8_t>(*max == 255 ? value : std::min(255, (value * 255 + *max / 2) / *max));
  }
  return true;
}

void write_pgm(const std::filesystem::path& file, const GreyView& image) {
  std::string bytes = "P5\n" + std::to_string(image.width) + ' ' + std::to_string(image.height) + "\n255\n";
  bytes.append(reinterpret_cast<const char*>(image.pixels.data()),
               static_cast<std::size_t>(image.width) * image.height);
  write_whole_file(file, bytes);
}

}  // namespace luminav
