#include "tests/replay/replay_nodes.hpp"

#include <fmt/format.h>

#include <map>
#include <opencv2/core.hpp>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/channels.hpp"
#include "services/controller/controller_node.hpp"
#include "services/detector/detector_node.hpp"
#include "services/localizer/localizer_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/planner/planner_node.hpp"

namespace luminav {
namespace {

using Channels = std::set<std::string>;

struct Interface {
  Channels inputs;
  Channels outputs;
};

const std::map<std::string, Interface>& interfaces() {
  namespace c = channels;
  static const std::map<std::string, Interface> all = {
      {"detector", {{c::kCameraImage}, {c::kFixtureDetections}}},
      {"localizer",
       {{c::kOdometry, c::kFixtureDetections, c::kSonar, c::kRobotStatus, c::kInitialPose},
        {c::kPose, c::kHypotheses}}},
      {"mapper", {{c::kPose, c::kSonar, c::kMapCommand, c::kTileRequest}, {c::kGridTile}}},
      {"planner",
       {{c::kGoal, c::kGridTile, c::kPose, c::kControlStatus, c::kRobotStatus},
        {c::kPath, c::kNavigationStatus, c::kTileRequest}}},
      {"controller",
       {{c::kPath, c::kNavigationStatus, c::kGridTile, c::kPose, c::kHypotheses, c::kOdometry, c::kSonar,
         c::kRobotStatus, c::kStop, c::kTeleopCommand, c::kSpeedLimit},
        {c::kVelocityCommand, c::kControlStatus}}}};
  return all;
}

}  // namespace

const std::vector<std::string>& replayable_nodes() {
  static const std::vector<std::string> names = {"detector", "localizer", "mapper", "planner", "controller"};
  return names;
}

const std::set<std::string>& inputs_of(const std::string& node) {
  return interfaces().at(node).inputs;
}
const std::set<std::string>& outputs_of(const std::string& node) {
  return interfaces().at(node).outputs;
}

struct ReplayNodes::Parts {
  lcm::LCM lcm{"memq://"};
  std::unique_ptr<DetectorNode> detector;
  std::unique_ptr<LocalizerNode> localizer;
  std::unique_ptr<MapperNode> mapper;
  std::unique_ptr<PlannerNode> planner;
  std::unique_ptr<ControllerNode> controller;
};

ReplayNodes::ReplayNodes(const ReplayNodesConfig& config) : parts_(std::make_unique<Parts>()) {
  cv::setNumThreads(1);
  for (const std::string& node : config.nodes) {
    if (!interfaces().contains(node)) {
      throw ConfigurationError(
          fmt::format("--nodes: unknown node {}, must be of {}", node, fmt::join(replayable_nodes(), ", ")));
    }
    inputs_.insert(inputs_of(node).begin(), inputs_of(node).end());
    outputs_.insert(outputs_of(node).begin(), outputs_of(node).end());
  }
  for (const std::string& channel : outputs_) {
    inputs_.erase(channel);
  }
  Parts& p = *parts_;
  if (config.nodes.contains("detector")) {
    DetectorConfig detector = read_detector_config(config.robot_file, config.building_file);
    detector.camera.mounting.x += config.camera_shift;
    p.detector = std::make_unique<DetectorNode>(p.lcm, detector);
  }
  if (config.nodes.contains("localizer")) {
    LocalizerConfig localizer = read_localizer_config(config.robot_file, config.building_file);
    localizer.seed = config.localizer_seed.value_or(localizer.seed);
    p.localizer = std::make_unique<LocalizerNode>(p.lcm, localizer);
  }
  if (config.nodes.contains("mapper")) {
    p.mapper = std::make_unique<MapperNode>(p.lcm, read_mapper_config(config.robot_file, config.building_file));
  }
  if (config.nodes.contains("planner")) {
    PlannerConfig planner = read_planner_config(config.robot_file, config.building_file);
    planner.local_clock = ahead_of_universal(config.utc_offset);
    p.planner = std::make_unique<PlannerNode>(p.lcm, planner);
  }
  if (config.nodes.contains("controller")) {
    ControllerConfig controller = read_controller_config(config.robot_file, config.building_file);
    controller.local_clock = ahead_of_universal(config.utc_offset);
    p.controller = std::make_unique<ControllerNode>(p.lcm, controller);
  }
}

ReplayNodes::~ReplayNodes() = default;

lcm::LCM& ReplayNodes::lcm() {
  return parts_->lcm;
}

std::int64_t ReplayNodes::dropped() const {
  std::int64_t sum = 0;
  const auto add = [&sum](const auto& node) { sum += node ? node->health().dropped_inputs : 0; };
  add(parts_->detector);
  add(parts_->localizer);
  add(parts_->mapper);
  add(parts_->planner);
  add(parts_->controller);
  return sum;
}

}  // namespace luminav
