#include "tests/evaluation/runs/whole_robot.hpp"

#include <luminav/sim_truth_t.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "drivers/base/base_driver.hpp"
#include "drivers/camera/camera_node.hpp"
#include "drivers/camera/simulated/ceiling.hpp"
#include "drivers/create2/create2_node.hpp"
#include "drivers/p3dx/p3dx_node.hpp"
#include "drivers/simulator/arcos/arcos_controller.hpp"
#include "drivers/simulator/create2/create2_board.hpp"
#include "drivers/simulator/simulator_node.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/controller/controller_node.hpp"
#include "services/detector/detector_node.hpp"
#include "services/jobs/jobs_node.hpp"
#include "services/localizer/localizer_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/planner/planner_node.hpp"
#include "services/surveyor/live/surveyor_node.hpp"
#include "tests/evaluation/runs/job_plan.hpp"
#include "tests/evaluation/sensing/geometric_sensing.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using namespace std::string_literals;

constexpr std::int64_t kStep = 10'000;  // [us]

/// Moves bytes between the simulated microcontroller and the driver's line, and pulls the plug when the scenario does.
class SerialLine {
 public:
  explicit SerialLine(BaseBoard& board) : board_(board) {}

  void exchange() {
    if (robot_end_ == nullptr || !robot_end_->is_open()) {
      if (unplugged_) {
        return;
      }
      robot_end_ = pipe_.open_robot_end();
    }
    std::uint8_t buffer[512];
    while (const std::size_t count = robot_end_->read(buffer)) {
      board_.receive({buffer, count});
    }
    const std::vector<std::uint8_t> output = board_.take_output();
    robot_end_->write(output);
  }
  void set_unplugged(bool unplugged) {
    if (unplugged != unplugged_) {
      unplugged_ = unplugged;
      unplugged ? pipe_.unplug() : pipe_.plug_in();
    }
  }
  MemoryPipe& pipe() { return pipe_; }

 private:
  BaseBoard& board_;
  MemoryPipe pipe_;
  std::unique_ptr<ByteStream> robot_end_;
  bool unplugged_ = false;
};

template <typename Mode>
void override_mode(Mode& mode, const std::string& word) {
  if (!word.empty()) {
    mode = word == "paper" ? Mode::kPaper : Mode::kModern;
  }
}

}  // namespace

struct WholeRobot::Parts {
  Parts(const Scenario& s, const WholeRobotOptions& o)
      : scenario(s),
        options(o),
        believed(read_building(s.building_file)),
        hung(read_building(s.true_building_file)),
        robot(read_robot(s.robot_file)),
        world(draw_world(s, hung, robot)),
        board(make_board()),
        serial(*board),
        simulator(lcm, scenario.seed, world, *board),
        subscriber(lcm) {
    subscriber.on(channels::kSimTruth, &Parts::on_truth, this);
    if (options.geometric != nullptr) {
      sensing = std::make_unique<GeometricSensing>(lcm, world, hung, robot.camera, *options.geometric, s.seed);
    } else {
      ceiling = std::make_unique<SimulatedCeiling>(world, scenario.seed);
    }
    start_base();
    const bool surveys = !options.survey_folder.empty();
    for (const char* process : {"camera", "detector", "localizer", "mapper", "planner", "controller"}) {
      if (!surveys || (process != "detector"s && process != "localizer"s && process != "mapper"s)) {
        start(process);
      }
    }
    if (surveys) {
      start("surveyor");
    }
    if (scenario.jobs.count > 0) {
      jobs_folder = std::make_unique<TemporaryFolder>();
      start("jobs");
    }
    began = clock.utime();
  }

  [[nodiscard]] JobsConfig jobs_config() const {
    JobsConfig config = read_jobs_config(scenario.robot_file, scenario.building_file);
    config.state_folder = jobs_folder->path();
    config.boot = "the same";
    config.site.jobs.home = scenario.dock ? scenario.dock->place : "";
    config.site.jobs.has_charger = scenario.dock.has_value();
    config.site.jobs.tours = draw_jobs(scenario, believed).tours;
    return config;
  }

  void tell_time() {
    if (jobs && (clock.utime() - began) % 1'000'000 == 0) {
      jobs->tell_time(local_time(clock.utime()));
    }
  }

  [[nodiscard]] LocalTime local_time(std::int64_t utime) const {
    constexpr std::int64_t kMonday = 4 * 86'400;  // [s] since the epoch: the first one
    return universal_time(1'000'000 * (kMonday + kMorning) + utime - began);
  }
  [[nodiscard]] LocalClock local_clock() const {
    return [this](std::int64_t utime) { return local_time(utime); };
  }

  [[nodiscard]] std::unique_ptr<BaseBoard> make_board() const {
    if (scenario.base == "create2") {
      return std::make_unique<Create2Board>(robot.wheel_base);
    }
    ArcosConfig config;
    config.wheel_base = robot.wheel_base;
    return std::make_unique<ArcosController>(config);
  }

  void on_truth(const sim_truth_t& truth) {
    serial.set_unplugged(truth.serial_unplugged != 0);
    if (sensing) {
      sensing->on_truth(truth);
    }
  }

  void start_base() {
    base.reset();
    if (scenario.base == "create2") {
      base = std::make_unique<Create2Node>(lcm, read_create2_config(scenario.robot_file), clock,
                                           serial.pipe().driver_opener());
    } else {
      base =
          std::make_unique<P3dxNode>(lcm, read_p3dx_config(scenario.robot_file), clock, serial.pipe().driver_opener());
    }
  }

  void start(const std::string& process) {
    if (process == scenario.base) {
      start_base();
    } else if (process == "camera") {
      if (sensing) {
        return;  // keeps no state that a restart would lose
      }
      camera.reset();
      CameraConfig config = read_camera_config(scenario.robot_file);
      if (!options.mode.empty()) {
        config.exposure.two_exposures = config.exposure.two_exposures && options.mode != "paper";
        config.exposure.lit_target = options.mode == "paper" ? 1.0 : ExposureParams{}.lit_target;
      }
      config.encoding = options.jpeg ? ImageEncoding::kJpeg : ImageEncoding::kMono8;
      camera = std::make_unique<CameraNode>(lcm, config, clock, *ceiling);
    } else if (process == "detector") {
      if (sensing) {
        return;
      }
      detector.reset();
      DetectorConfig config = read_detector_config(scenario.robot_file, scenario.building_file);
      override_mode(config.params.mode, options.mode);
      detector = std::make_unique<DetectorNode>(lcm, config);
    } else if (process == "localizer") {
      localizer.reset();
      LocalizerConfig config = read_localizer_config(scenario.robot_file, scenario.building_file);
      override_mode(config.mode, options.mode);
      config.seed = scenario.seed;
      localizer = std::make_unique<LocalizerNode>(lcm, config);
    } else if (process == "mapper") {
      mapper.reset();
      MapperConfig config = read_mapper_config(scenario.robot_file, scenario.building_file);
      if (!options.mode.empty()) {
        config.grid.sonar.kind = options.mode == "paper" ? SonarModelKind::kLine : SonarModelKind::kCone;
      }
      mapper = std::make_unique<MapperNode>(lcm, config);
    } else if (process == "planner") {
      planner.reset();
      PlannerConfig config = read_planner_config(scenario.robot_file, scenario.building_file);
      override_mode(config.route.mode, options.mode);
      config.local_clock = local_clock();
      if (!options.survey_folder.empty()) {
        config.plan_on_a_new_map();
      }
      planner = std::make_unique<PlannerNode>(lcm, config);
    } else if (process == "controller") {
      controller.reset();
      ControllerConfig config = read_controller_config(scenario.robot_file, scenario.building_file);
      config.local_clock = local_clock();
      controller = std::make_unique<ControllerNode>(lcm, config);
    } else if (process == "surveyor" && !options.survey_folder.empty()) {
      start_surveyor();
    } else if (process == "jobs" && jobs_folder) {
      jobs.reset();
      jobs = std::make_unique<JobsNode>(lcm, jobs_config());
    } else {
      throw std::invalid_argument("whole robot: no process " + process);
    }
  }

  void start_surveyor() {
    surveyor.reset();
    SurveyorConfig config = read_surveyor_config(scenario.robot_file, options.kinds_file, options.survey_folder);
    config.source = sensing ? SightingSource::kDetections : SightingSource::kImagesElseDetections;
    surveyor = std::make_unique<SurveyorNode>(lcm, config);
    surveyor->explore_at_once();
  }

  void drain() {
    while (lcm.handleTimeout(0) > 0) {
    }
    if (surveyor) {
      surveyor->settle();  // else what it knows when would depend on the machine
    }
  }

  lcm::LCM lcm{"memq://"};
  VirtualClock clock;
  Scenario scenario;
  WholeRobotOptions options;
  Building believed;
  Building hung;  // what the world is drawn around
  RobotDescription robot;
  WorldTruth world;
  std::unique_ptr<BaseBoard> board;
  SerialLine serial;
  SimulatorNode simulator;
  std::unique_ptr<SimulatedCeiling> ceiling;
  std::unique_ptr<GeometricSensing> sensing;
  Subscriber subscriber;
  std::unique_ptr<BaseDriver> base;
  std::unique_ptr<CameraNode> camera;
  std::unique_ptr<DetectorNode> detector;
  std::unique_ptr<LocalizerNode> localizer;
  std::unique_ptr<MapperNode> mapper;
  std::unique_ptr<PlannerNode> planner;
  std::unique_ptr<ControllerNode> controller;
  std::unique_ptr<SurveyorNode> surveyor;
  std::unique_ptr<TemporaryFolder> jobs_folder;  // where its table lies; none without jobs
  std::unique_ptr<JobsNode> jobs;
  std::int64_t began = 0;  // [us]
};

WholeRobot::WholeRobot(const Scenario& scenario, const WholeRobotOptions& options) {
  cv::setNumThreads(1);
  parts_ = std::make_unique<Parts>(scenario, options);
}

WholeRobot::~WholeRobot() = default;

lcm::LCM& WholeRobot::lcm() {
  return parts_->lcm;
}
const WorldTruth& WholeRobot::world() const {
  return parts_->world;
}
World& WholeRobot::simulated_world() {
  return parts_->simulator.world();
}
const Building& WholeRobot::believed_building() const {
  return parts_->believed;
}
const RobotDescription& WholeRobot::believed_robot() const {
  return parts_->robot;
}
std::int64_t WholeRobot::utime() const {
  return parts_->clock.utime();
}

bool WholeRobot::has_surveyed() const {
  return parts_->surveyor && parts_->surveyor->is_finished();
}

LocalClock WholeRobot::local_clock() const {
  return parts_->local_clock();
}

void WholeRobot::step() {
  Parts& p = *parts_;
  p.clock.advance(kStep);
  p.simulator.advance_to(p.clock.utime());
  p.serial.exchange();
  p.drain();
  p.base->poll();
  p.drain();
  p.serial.exchange();
  if (p.camera) {
    p.camera->poll();
    p.drain();
  }
  p.tell_time();
}

void WholeRobot::restart(const std::string& process) {
  parts_->start(process);
}

}  // namespace luminav
