#include "drivers/camera/sources/v4l2_camera.hpp"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace luminav {
namespace {

V4l2CameraParams on_device(const std::string& path) {
  V4l2CameraParams params;
  params.device = path;
  return params;
}

TEST(V4l2Camera, AMissingDeviceIsLookedForWithGrowingDelays) {
  VirtualClock clock;
  V4l2Camera camera(on_device("/dev/no-such-camera"), clock);
  EXPECT_EQ(camera.descriptor(), -1);
  EXPECT_NE(camera.fault().find("/dev/no-such-camera"), std::string::npos) << camera.fault();
  EXPECT_TRUE(camera.set_exposure(5000.0, 1.0)) << "kept until there is a device";
  Frame frame;
  std::vector<std::int64_t> delays;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(camera.due());
    delays.push_back(*camera.due() - clock.utime());
    clock.advance(delays.back() - 1);
    const auto before = camera.due();
    EXPECT_FALSE(camera.take(clock.utime(), frame));
    EXPECT_EQ(camera.due(), before) << "looked for too early";
    clock.advance(1);
    EXPECT_FALSE(camera.take(clock.utime(), frame));
  }
  EXPECT_EQ(delays, (std::vector<std::int64_t>{500'000, 1'000'000, 2'000'000, 4'000'000, 8'000'000, 8'000'000,
                                               8'000'000, 8'000'000}));
}

TEST(V4l2Camera, ADeviceThatIsNoCameraIsSaidToBeNone) {
  const VirtualClock clock;
  const V4l2Camera camera(on_device("/dev/null"), clock);
  EXPECT_NE(camera.fault().find("is no video device"), std::string::npos) << camera.fault();
}

V4l2Offer offer(std::uint32_t pixel_format, int width, int height, double max_rate) {
  return {{pixel_format, width, height, 0}, max_rate};
}

TEST(V4l2Camera, TakesTheFormatThatHasTheSizeAndThenTheRate) {
  const std::vector<V4l2Offer> small_raw = {offer(V4L2_PIX_FMT_YUYV, 640, 480, 30.0),
                                            offer(V4L2_PIX_FMT_MJPEG, 1280, 960, 30.0)};
  EXPECT_EQ(nearest_offer(small_raw, 1280, 960, 15.0).format.pixel_format, V4L2_PIX_FMT_MJPEG);
  EXPECT_EQ(nearest_offer(small_raw, 640, 480, 15.0).format.pixel_format, V4L2_PIX_FMT_YUYV);
  const std::vector<V4l2Offer> slow_raw = {offer(V4L2_PIX_FMT_YUYV, 1280, 960, 7.5),
                                           offer(V4L2_PIX_FMT_MJPEG, 1280, 960, 30.0)};
  EXPECT_EQ(nearest_offer(slow_raw, 1280, 960, 15.0).format.pixel_format, V4L2_PIX_FMT_MJPEG);
  EXPECT_EQ(nearest_offer(slow_raw, 1280, 960, 7.501).format.pixel_format, V4L2_PIX_FMT_YUYV) << "nothing is lost";
  const std::vector<V4l2Offer> untold = {offer(V4L2_PIX_FMT_GREY, 640, 480, std::numeric_limits<double>::infinity()),
                                         offer(V4L2_PIX_FMT_YUYV, 640, 480, 30.0)};
  EXPECT_EQ(nearest_offer(untold, 640, 480, 15.0).format.pixel_format, V4L2_PIX_FMT_GREY);
}

}  // namespace
}  // namespace luminav
