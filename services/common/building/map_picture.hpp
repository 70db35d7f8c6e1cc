#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace luminav {

struct MapPixel {
  std::uint8_t grey = 0;       // 0 = black, 255 = white
  std::uint8_t opacity = 255;  // 0 = transparent
};

/// The picture of a map, row by row from the top: a binary PGM (P5, 8 bits), which may be larger than all else in
/// memory, or a PNG of any kind; the first bytes say which. Throws ConfigurationError naming the file and what is wrong
/// (missing, cut, another format, too large).
class MapPicture {
 public:
  explicit MapPicture(std::filesystem::path file);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Valid until the next one is read; to be called `height` times.
  std::span<const MapPixel> next_row();

 private:
  void open_pgm();
  void open_png();
  int read_header_number();
  void check_size() const;
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path file_;
  std::ifstream in_;
  int width_ = 0;
  int height_ = 0;
  int max_ = 255;  // of a PGM's bytes
  int rows_read_ = 0;
  std::vector<MapPixel> row_;
  std::vector<std::uint8_t> png_;  // grey and opacity of all pixels; empty for a PGM
};

}  // namespace luminav
