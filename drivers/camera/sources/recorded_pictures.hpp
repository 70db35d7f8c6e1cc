#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "drivers/camera/sources/frame_source.hpp"
#include "services/common/image/jpeg_codec.hpp"

namespace luminav {

/// Part of a file.
struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
};

/// Where whole JPEG pictures lie in a file of pictures one after another, as in a motion-JPEG stream or AVI; what lies
/// between them is skipped, and a picture that is cut at the end is left out.
std::vector<ByteRange> find_jpegs(std::span<const std::uint8_t> bytes);

/// Shows pictures from disk at a steady rate, once, and then says that it is at the end. JPEG and PGM; a picture that
/// cannot be read is counted and left out. Their exposure is not known.
class RecordedPictures final : public FrameSource {
 public:
  /// All *.jpg, *.jpeg and *.pgm of a folder, by name. Throws std::runtime_error when there is none.
  static RecordedPictures in_folder(const std::filesystem::path& folder, double rate);
  /// A motion-JPEG file, a single JPEG or a PGM. Throws std::runtime_error when there is no picture in it.
  static RecordedPictures in_file(const std::filesystem::path& file, double rate);

  [[nodiscard]] std::optional<std::int64_t> due() const override {
    return next_ < pictures_.size() ? due_ : std::nullopt;
  }
  [[nodiscard]] bool take(std::int64_t now, Frame& frame) override;
  bool set_exposure(double, double) override { return false; }
  [[nodiscard]] std::string fault() const override;
  [[nodiscard]] std::string shortcoming() const override;
  [[nodiscard]] std::string description() const override;
  [[nodiscard]] std::size_t size() const { return pictures_.size(); }

 private:
  struct Picture {
    std::filesystem::path file;
    ByteRange range;
  };
  RecordedPictures(std::string name, std::vector<Picture> pictures, double rate);
  [[nodiscard]] bool read(const Picture& picture, GreyImage& image);

  std::string name_;
  std::vector<Picture> pictures_;
  std::int64_t period_;  // [us]
  std::optional<std::int64_t> due_;
  std::size_t next_ = 0;
  std::size_t damaged_ = 0;
  std::vector<std::uint8_t> bytes_;
  JpegDecoder decoder_;
};

}  // namespace luminav
