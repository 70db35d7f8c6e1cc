#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace luminav {

/// Layout of a device's frames.
struct V4l2Format {
  std::uint32_t pixel_format = 0;  // V4L2_PIX_FMT_GREY, _YUYV or _MJPEG
  int width = 0;                   // [px]
  int height = 0;                  // [px]
  int stride = 0;                  // [bytes] from row to row; of MJPEG 0
};

/// A format that a device has, with the rate that it reaches in it.
struct V4l2Offer {
  V4l2Format format;
  double max_rate = std::numeric_limits<double>::infinity();  // [frames/s] infinite where the device does not tell
};

/// The offer nearest to what is wanted: in size first, then in rate; the first of equals. `offers` must not be empty.
[[nodiscard]] const V4l2Offer& nearest_offer(std::span<const V4l2Offer> offers, int width, int height, double rate);

/// A filled buffer, lent until `give_back`.
struct V4l2Buffer {
  std::uint32_t index = 0;
  std::span<const std::uint8_t> bytes;
  std::int64_t stamp = 0;  // [us] monotonic clock of the host, as the kernel took it
  bool stamp_is_monotonic = false;
  bool stamp_is_start = false;  // of the exposure; else of the end of the frame
  bool damaged = false;
};

/// Range of a control in the device's own units.
struct V4l2Range {
  int min = 0;
  int max = 0;
  int step = 1;
};

/// A Linux video capture device with memory-mapped buffers: ioctls and ownership, nothing else. Not one call blocks.
class V4l2Device {
 public:
  /// Opens it, agrees on a format as near as possible to what is wanted (of equally near ones grey before YUYV before
  /// MJPEG, because the first two lose nothing) and starts it. Throws std::runtime_error with one plain sentence.
  V4l2Device(const std::string& path, int width, int height, double rate);
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;
  ~V4l2Device();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] const V4l2Format& format() const { return format_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// The next filled buffer; nothing when there is none yet. Throws std::runtime_error when the device is gone.
  [[nodiscard]] std::optional<V4l2Buffer> take();
  void give_back(const V4l2Buffer& buffer);

  [[nodiscard]] std::optional<V4l2Range> range_of(std::uint32_t control) const;
  /// Sets a control and reads it back; nothing when the device refuses.
  std::optional<int> set(std::uint32_t control, int value);

 private:
  void open_device(const std::string& path);
  void choose_format(int width, int height, double rate);
  [[nodiscard]] std::optional<V4l2Offer> offer_of(std::uint32_t pixel_format, int width, int height) const;
  [[nodiscard]] double max_rate(const V4l2Format& format) const;
  void choose_rate(double rate) const;
  void start();
  void release();
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  std::string name_;
  int descriptor_ = -1;
  V4l2Format format_;
  std::vector<std::span<std::uint8_t>> buffers_;
};

}  // namespace luminav
