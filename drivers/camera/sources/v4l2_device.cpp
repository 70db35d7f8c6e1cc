#include "drivers/camera/sources/v4l2_device.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace luminav {
namespace {

constexpr std::uint32_t kBuffers = 4;

int control_device(int descriptor, unsigned long request, void* argument) {
  int result = -1;
  do {
    result = ioctl(descriptor, request, argument);
  } while (result < 0 && errno == EINTR);
  return result;
}

v4l2_format wish_for(std::uint32_t pixel_format, int width, int height) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(width);
  format.fmt.pix.height = static_cast<std::uint32_t>(height);
  format.fmt.pix.pixelformat = pixel_format;
  format.fmt.pix.field = V4L2_FIELD_ANY;
  return format;
}

V4l2Format layout_of(const v4l2_format& format) {
  return {format.fmt.pix.pixelformat, static_cast<int>(format.fmt.pix.width), static_cast<int>(format.fmt.pix.height),
          static_cast<int>(format.fmt.pix.bytesperline)};
}

}  // namespace

const V4l2Offer& nearest_offer(std::span<const V4l2Offer> offers, int width, int height, double rate) {
  const auto distance = [&](const V4l2Offer& offer) {
    constexpr double kSameRate = 0.99;  // intervals are rounded: 333333/10000000 s is 30 frames/s
    const double lacking = offer.max_rate < kSameRate * rate ? rate - offer.max_rate : 0.0;
    return std::pair(std::abs(offer.format.width - width) + std::abs(offer.format.height - height), lacking);
  };
  return *std::min_element(offers.begin(), offers.end(),
                           [&](const V4l2Offer& a, const V4l2Offer& b) { return distance(a) < distance(b); });
}

V4l2Device::V4l2Device(const std::string& path, int width, int height, double rate) : path_(path) {
  try {
    open_device(path);
    choose_format(width, height, rate);
    choose_rate(rate);
    start();
  } catch (...) {
    release();
    throw;
  }
}

V4l2Device::~V4l2Device() {
  release();
}

void V4l2Device::release() {
  if (descriptor_ >= 0) {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    control_device(descriptor_, VIDIOC_STREAMOFF, &type);
  }
  for (const auto& buffer : buffers_) {
    munmap(buffer.data(), buffer.size());
  }
  buffers_.clear();
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
  descriptor_ = -1;
}

void V4l2Device::fail(const std::string& what) const {
  const int error = errno;
  throw std::runtime_error(
      path_ + ": " + what + ": " +
      (error == EBUSY ? std::string("another program uses it") : std::string(std::strerror(error))));
}

void V4l2Device::open_device(const std::string& path) {
  descriptor_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) {
    fail("cannot open the camera");
  }
  v4l2_capability capability{};
  if (control_device(descriptor_, VIDIOC_QUERYCAP, &capability) < 0) {
    fail("is no video device");
  }
  const std::uint32_t flags =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((flags & V4L2_CAP_VIDEO_CAPTURE) == 0 || (flags & V4L2_CAP_STREAMING) == 0) {
    throw std::runtime_error(path_ + ": does not stream pictures; a webcam often has a second device that does not");
  }
  name_ = reinterpret_cast<const char*>(capability.card);
}

std::optional<V4l2Offer> V4l2Device::offer_of(std::uint32_t pixel_format, int width, int height) const {
  v4l2_format format = wish_for(pixel_format, width, height);
  if (control_device(descriptor_, VIDIOC_TRY_FMT, &format) < 0 || format.fmt.pix.pixelformat != pixel_format) {
    return std::nullopt;  // the driver would choose another one
  }
  V4l2Offer offer{layout_of(format)};
  offer.max_rate = max_rate(offer.format);
  return offer;
}

double V4l2Device::max_rate(const V4l2Format& format) const {
  double max = 0.0;
  v4l2_frmivalenum interval{};
  interval.pixel_format = format.pixel_format;
  interval.width = static_cast<std::uint32_t>(format.width);
  interval.height = static_cast<std::uint32_t>(format.height);
  for (; control_device(descriptor_, VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0; ++interval.index) {
    const v4l2_fract& shortest =
        interval.type == V4L2_FRMIVAL_TYPE_DISCRETE ? interval.discrete : interval.stepwise.min;
    if (shortest.numerator > 0) {
      max = std::max(max, static_cast<double>(shortest.denominator) / shortest.numerator);
    }
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      break;  // one entry says it all
    }
  }
  return max > 0.0 ? max : std::numeric_limits<double>::infinity();
}

void V4l2Device::choose_format(int width, int height, double rate) {
  std::vector<V4l2Offer> offers;
  for (const std::uint32_t pixel_format : {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG}) {
    if (const auto offer = offer_of(pixel_format, width, height)) {
      offers.push_back(*offer);
    }
  }
  if (offers.empty()) {
    throw std::runtime_error(path_ + ": offers neither GREY nor YUYV nor MJPEG pictures");
  }
  v4l2_format format = wish_for(nearest_offer(offers, width, height, rate).format.pixel_format, width, height);
  if (control_device(descriptor_, VIDIOC_S_FMT, &format) < 0) {
    fail("cannot set the picture's format");
  }
  format_ = layout_of(format);
}

void V4l2Device::choose_rate(double rate) const {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  parameters.parm.capture.timeperframe.numerator = 1000;
  parameters.parm.capture.timeperframe.denominator = static_cast<std::uint32_t>(std::lround(1000.0 * rate));
  // Some cameras have one rate only: then frames come faster or slower, and are stamped all the same.
  control_device(descriptor_, VIDIOC_S_PARM, &parameters);
}

void V4l2Device::start() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (control_device(descriptor_, VIDIOC_REQBUFS, &request) < 0) {
    fail("cannot get buffers");
  }
  for (std::uint32_t index = 0; index < request.count; ++index) {
    v4l2_buffer buffer{};
    buffer.type = request.type;
    buffer.memory = request.memory;
    buffer.index = index;
    if (control_device(descriptor_, VIDIOC_QUERYBUF, &buffer) < 0) {
      fail("cannot ask for a buffer");
    }
    void* memory = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, buffer.m.offset);
    if (memory == MAP_FAILED) {
      fail("cannot map a buffer");
    }
    buffers_.emplace_back(static_cast<std::uint8_t*>(memory), buffer.length);
    if (control_device(descriptor_, VIDIOC_QBUF, &buffer) < 0) {
      fail("cannot queue a buffer");
    }
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (control_device(descriptor_, VIDIOC_STREAMON, &type) < 0) {
    fail("cannot start");
  }
}

std::optional<V4l2Buffer> V4l2Device::take() {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (control_device(descriptor_, VIDIOC_DQBUF, &buffer) < 0) {
    if (errno == EAGAIN) {
      return std::nullopt;
    }
    fail("the camera is gone");
  }
  if (buffer.index >= buffers_.size()) {
    throw std::runtime_error(path_ + ": the driver handed out a buffer that does not exist");
  }
  V4l2Buffer result;
  result.index = buffer.index;
  const auto& memory = buffers_[buffer.index];
  result.bytes = std::span<const std::uint8_t>(memory).first(std::min<std::size_t>(buffer.bytesused, memory.size()));
  result.stamp = static_cast<std::int64_t>(buffer.timestamp.tv_sec) * 1'000'000 + buffer.timestamp.tv_usec;
  result.stamp_is_monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  result.stamp_is_start = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  result.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  return result;
}

void V4l2Device::give_back(const V4l2Buffer& lent) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = lent.index;
  if (control_device(descriptor_, VIDIOC_QBUF, &buffer) < 0) {
    fail("cannot queue a buffer");
  }
}

std::optional<V4l2Range> V4l2Device::range_of(std::uint32_t control) const {
  v4l2_queryctrl query{};
  query.id = control;
  if (control_device(descriptor_, VIDIOC_QUERYCTRL, &query) < 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) {
    return std::nullopt;
  }
  return V4l2Range{query.minimum, query.maximum, std::max(1, query.step)};
}

std::optional<int> V4l2Device::set(std::uint32_t control, int value) {
  v4l2_control wish{};
  wish.id = control;
  wish.value = value;
  if (control_device(descriptor_, VIDIOC_S_CTRL, &wish) < 0 || control_device(descriptor_, VIDIOC_G_CTRL, &wish) < 0) {
    return std::nullopt;
  }
  return wish.value;
}

}  // namespace luminav
