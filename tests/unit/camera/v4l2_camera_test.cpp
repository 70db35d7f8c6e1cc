#include "drivers/camera/v4l2_camera.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace luminav
