#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "drivers/camera/camera_node.hpp"
#include "drivers/camera/simulated/ceiling.hpp"
#include "drivers/camera/sources/pgm_file.hpp"
#include "drivers/camera/sources/recorded_pictures.hpp"
#include "drivers/camera/sources/v4l2_camera.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"

namespace luminav {
namespace {

struct Arguments {
  std::string robot_file;
  std::string source = "sim";
  std::string scenario_file;
  std::int64_t seed = -1;
  std::string lcm_url;
  std::string image_url;
  std::string state_folder;
  std::string still;
  std::string out = "still.pgm";
};

SimulatedCeiling open_simulated(const Arguments& arguments, const CameraConfig& config) {
  if (arguments.scenario_file.empty()) {
    throw ConfigurationError("--source sim needs --scenario FILE");
  }
  Scenario scenario = read_scenario(arguments.scenario_file);
  if (arguments.seed >= 0) {
    scenario.seed = static_cast<std::uint64_t>(arguments.seed);
  }
  const Building building = read_building(scenario.true_building_file);
  const WorldTruth truth = draw_world(scenario, building, read_robot(arguments.robot_file));
  SimulatedCeilingParams params;
  params.rate = config.rate;
  return {truth, scenario.seed, params};
}

void write_still(SimulatedCeiling& ceiling, const Arguments& arguments) {
  Pose2 pose;
  if (std::sscanf(arguments.still.c_str(), "%lf,%lf,%lf", &pose.x, &pose.y, &pose.theta) != 3) {
    throw ConfigurationError("--render must be X,Y,THETA in metres and radians");
  }
  GreyImage image;
  ceiling.render_still(pose, 8000.0, 1.0, image);
  write_pgm(arguments.out, image.view());
}

template <typename Source>
int run(const Arguments& arguments, const CameraConfig& config, const Clock& clock, Source& source) {
  const NetworkAccess access = read_network_access(arguments.robot_file);
  const LcmNetwork network = access.on(arguments.lcm_url);
  const auto lcm = open_lcm(network);
  // Pictures are most of what is said on the network: they may stay on the machine while the rest goes further.
  const auto images = arguments.image_url.empty() ? nullptr : open_lcm(access.on(arguments.image_url));
  CameraNode node(images ? *images : *lcm, config, clock, source);
  receive_only(images ? *images : *lcm, images ? access.on(arguments.image_url) : network, node.channels());
  fmt::print("camera: {}\n", source.description());
  std::fflush(stdout);
  EventLoop loop(*lcm, "camera", config.robot, network);
  loop.belong_to(arguments.robot_file);
  loop.watch([&] { return node.descriptor(); }, [&] { node.poll(); });
  if (images) {
    loop.watch([&] { return images->getFileno(); },
               [&] {
                 while (images->handleTimeout(0) > 0) {
                 }
               });
  }
  loop.when_due([&] { return node.time_left(); }, [&] { node.poll(); });
  loop.report_health([&] { return node.health(); });
  node.poll();
  return loop.run();
}

int camera(const Arguments& arguments) {
  const CameraConfig config = read_camera_config(arguments.robot_file);
  if (config.encoding == ImageEncoding::kMono8) {
    throw ConfigurationError(arguments.robot_file +
                             ": [camera_driver] encoding = \"mono8\" does not fit into a datagram, must be \"jpeg\" in "
                             "a process of its own");
  }
  const std::string& source = arguments.source;
  const std::string path = source.substr(std::min(source.size(), source.find(':') + 1));
  const HostClock clock;
  if (source == "sim") {
    SimulatedCeiling ceiling = open_simulated(arguments, config);
    if (!arguments.still.empty()) {
      write_still(ceiling, arguments);
      return 0;
    }
    return run(arguments, config, clock, ceiling);
  }
  if (source.starts_with("v4l2:")) {
    const CameraIntrinsics& lens = config.camera.intrinsics;
    V4l2Camera device(
        {path, lens.width, lens.height, config.rate, config.camera.row_time * 1e6, config.exposure.max_gain}, clock);
    return run(arguments, config, clock, device);
  }
  if (source.starts_with("file:")) {
    RecordedPictures pictures = RecordedPictures::in_file(path, config.rate);
    return run(arguments, config, clock, pictures);
  }
  if (source.starts_with("dir:")) {
    RecordedPictures pictures = RecordedPictures::in_folder(path, config.rate);
    return run(arguments, config, clock, pictures);
  }
  throw ConfigurationError(fmt::format("--source {}: must be sim, v4l2:DEVICE, file:PATH or dir:PATH", source));
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  luminav::Arguments arguments;
  luminav::CommandLine line("camera", "Publishes pictures of the ceiling from a webcam, files or a simulated ceiling.");
  line.robot_file(arguments.robot_file)
      .text("--source", arguments.source, "sim | v4l2:DEVICE | file:PATH | dir:PATH")
      .text("--scenario", arguments.scenario_file, "of the simulated ceiling")
      .integer("--seed", arguments.seed, "instead of the scenario's")
      .lcm_url(arguments.lcm_url)
      .text("--image-url", arguments.image_url, "LCM network for pictures, as with ttl=0; default: the same one")
      .state_folder(arguments.state_folder)
      .text("--render", arguments.still, "X,Y,THETA: write what the simulated camera sees from there, and end")
      .output_file("--out", arguments.out, "PGM file for --render");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("camera", [&] { return luminav::camera(arguments); });
}
