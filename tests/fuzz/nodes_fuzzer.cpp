// One service or all of them on one network in one program, and a sequence of messages of any kind with any contents:
// nothing dies, nobody drives faster than the robot may, and no number that is none goes out.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "services/controller/controller_node.hpp"
#include "services/launcher/deputy/deputy.hpp"
#include "services/launcher/sheriff/sheriff.hpp"
#include "services/localizer/localizer_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/operator/goal_order.hpp"
#include "services/planner/planner_node.hpp"
#include "services/viewer/viewer_node.hpp"
#include "tests/fuzz/message_types.hpp"
#include "tests/node/launcher/fake_runner.hpp"
#include "tests/replay/log_reading/sample_message.hpp"

using namespace luminav;

namespace {

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

/// One handle for all runs: opening one costs more than a run.
lcm::LCM& network() {
  static lcm::LCM lcm("memq://");
  return lcm;
}

RobotDescription robot() {
  RobotDescription robot;
  robot.footprint = {{0.2, 0.2}, {-0.2, 0.2}, {-0.2, -0.2}, {0.2, -0.2}};
  robot.sonar.robot_from_sonar = {{0.2, 0.0, 0.0}, {0.0, 0.2, 1.5}};
  return robot;
}

PriorMap room() {
  PriorMap map;
  map.geometry = {0.2, {0.0, 0.0}, 30, 20};  // coarse: most of a run is making the walls' fields
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (int column = 0; column < 30; ++column) {
    map.cells[map.geometry.index({column, 0})] = map.cells[map.geometry.index({column, 19})] = Prior::kOccupied;
  }
  return map;
}

Building building() {
  Building building;
  building.name = "room";
  building.ceiling_height = 2.8;
  for (int i = 0; i < 4; ++i) {
    Fixture fixture;
    fixture.id = i + 1;
    fixture.world_from_fixture = {1.0 + i, 1.0 + i % 2, 0.0};
    fixture.length = 1.2;
    fixture.width = 0.3;
    building.fixtures.push_back(fixture);
  }
  return building;
}

LocalizerConfig localizer_config() {
  LocalizerConfig config;
  config.robot = robot();
  config.robot.camera.mounting.z = 0.3;
  config.building = building();
  config.walls = room();
  return config;
}

MapperConfig mapper_config() {
  MapperConfig config;
  config.robot = robot();
  config.prior = room();
  return config;
}

enum class Cast { kPlanner, kController, kMapper, kLocalizer, kViewer, kProcesses, kAll };
constexpr int kCasts = 7;

/// What the viewer's parts share.
struct Page {
  explicit Page(const Clock& clock)
      : viewer(network(), {.robot = robot(), .building = building()}, clock, board, pictures, desk, helm) {}
  SnapshotBoard board;
  PictureStore pictures;
  RequestDesk desk{network(), "fuzz"};
  Helm helm{network(), robot().limits};
  ViewerNode viewer;
};

/// Deputy, sheriff, and somebody who waits for a goal.
struct Launcher {
  Launcher() { sheriff.listen_for_readiness(network()); }
  static goal_t goal() {
    goal_t goal{};
    goal.utime = goal.id = kStart;
    goal.count = 1;
    goal.poses.resize(1);
    goal.poses[0].x = 3.0;
    goal.poses[0].y = 2.0;
    return goal;
  }
  launcher::FakeRunner runner;
  launcher::Deputy deputy{network(), {.id = "sample", .allow_any = true, .log_folder = ""}, runner};
  launcher::Sheriff sheriff{network(), {}, {.id = "sheriff:1:1", .observe = false}};
  GoalOrder order{network(), goal()};
};

/// Who must not be led astray, whoever speaks. A run with one of them takes a fifth of one with all.
class Robot {
 public:
  explicit Robot(Cast cast) : inbox_(network()) {
    const auto plays = [cast](Cast part) { return cast == part || cast == Cast::kAll; };
    if (plays(Cast::kPlanner)) {
      planner_.emplace(network(), PlannerConfig{.robot = robot(), .state_folder = ""});
    }
    if (plays(Cast::kController)) {
      controller_.emplace(network(), ControllerConfig::for_robot(robot()));
    }
    if (plays(Cast::kMapper)) {
      mapper_.emplace(network(), mapper_config());
    }
    if (plays(Cast::kLocalizer)) {
      localizer_.emplace(network(), localizer_config());
    }
    if (plays(Cast::kViewer)) {
      page_.emplace(clock_);
    }
    if (plays(Cast::kProcesses)) {
      launcher_.emplace();
    }
    inbox_.on(channels::kVelocityCommand, &Robot::on_command, this);
  }

  /// The next command that is delivered is the stranger's own.
  void expect_strangers_command() { is_strangers_ = true; }
  void deliver() {
    for (int i = 0; i < 1000 && network().handleTimeout(0) > 0; ++i) {
    }
    is_strangers_ = false;  // one that did not decode is not delivered
  }

  void tick(std::int64_t utime) {
    clock_.advance(20'000);
    if (launcher_) {
      const launcher::Instant now{.utime = utime, .steady = utime};
      launcher_->deputy.tick(now);
      launcher_->sheriff.tick(now);
      launcher_->order.tick();
    }
    if (page_) {
      page_->desk.repeat(utime);
      page_->viewer.show();
      page_->viewer.show_processes();
    }
    deliver();
    judge(planner_);
    judge(controller_);
    judge(mapper_);
    judge(localizer_);
  }

 private:
  template <typename Node>
  static void judge(const std::optional<Node>& node) {
    require(!node || node->health().reason.size() < 1000);
  }
  void on_command(const velocity_command_t& command) {
    if (is_strangers_) {
      is_strangers_ = false;
      return;
    }
    constexpr double kSlack = 1e-6;
    require(std::abs(command.linear_x) <= robot().limits.linear + kSlack && command.linear_y == 0.0 &&
            std::abs(command.angular_z) <= robot().limits.angular + kSlack);
  }

  VirtualClock clock_{kStart};
  std::optional<PlannerNode> planner_;
  std::optional<ControllerNode> controller_;
  std::optional<MapperNode> mapper_;
  std::optional<LocalizerNode> localizer_;
  std::optional<Page> page_;
  std::optional<Launcher> launcher_;
  Subscriber inbox_;
  bool is_strangers_ = false;
};

struct Speech {
  std::string channel;
  const TypeSchema* type;
};

/// What may be said on which channel.
std::vector<Speech> speeches() {
  const std::map<std::string, std::string> kOthers = {{"procman_orders_t", channels::kProcmanOrders},
                                                      {"procman_deputy_info_t", channels::kProcmanInfo},
                                                      {"procman_output_t", channels::kProcmanOutput},
                                                      {"procman_discovery_t", channels::kProcmanDiscover}};
  std::vector<Speech> speeches;
  for (const auto& [name, type] : MessageSchemas::built_in().types()) {
    const auto other = kOthers.find(name);
    speeches.push_back({other != kOthers.end() ? other->second : sample_channel(type), &type});
  }
  return speeches;
}

std::vector<std::uint8_t> sound_tile(std::int64_t utime, std::uint8_t which) {
  OccupancyGrid grid({0.1, {0.0, 0.0}, 100, 100});
  std::fill(grid.prior.begin(), grid.prior.end(), which % 2 == 0 ? Prior::kFree : Prior::kUnknown);
  grid_tile_t tile = encode_tile(grid, which / 2 % 2, which / 4 % 2);
  tile.utime = utime;
  tile.map_session = 2;
  tile.revision = which;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(tile.getEncodedSize()));
  tile.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

/// A byte for who is there. Messages: a byte for the channel, one for how many changes, then three for each: where
/// (two) and what. The highest bit of the second byte: without a stamp of its own.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Speech> kSpeeches = speeches();
  std::span input(data, size);
  const auto take = [&] {
    const std::uint8_t byte = input.empty() ? 0 : input.front();
    input = input.empty() ? input : input.subspan(1);
    return byte;
  };
  Robot robot(static_cast<Cast>(take() % kCasts));
  constexpr int kMaxMessages = 60;
  std::int64_t utime = kStart;
  for (int i = 0; i < kMaxMessages && !input.empty(); ++i) {
    utime += 20'000;
    const Speech& speech = kSpeeches[take() % kSpeeches.size()];
    const std::uint8_t mode = take();
    std::map<std::string, std::int64_t> numbers = {{"sequence", i}, {"id", utime}, {"action", mode >> 3 & 3}};
    if ((mode & 0x80) == 0) {
      numbers["utime"] = utime;
      numbers["range_utime"] = utime - 10'000;
    }
    std::vector<std::uint8_t> bytes = speech.type->name == "grid_tile_t" && (mode & 0x40) != 0
                                          ? sound_tile(utime, static_cast<std::uint8_t>(i))
                                          : sample_message(MessageSchemas::built_in(), *speech.type, numbers);
    for (int changes = mode & 7; changes > 0; --changes) {
      const std::size_t where = 8 + static_cast<std::size_t>(take() << 8 | take());
      const std::uint8_t what = take();
      if (bytes.size() > 8) {
        bytes[8 + where % (bytes.size() - 8)] = what;
      }
    }
    network().publish(speech.channel, bytes.data(), static_cast<unsigned>(bytes.size()));
    if (speech.channel == channels::kVelocityCommand) {
      robot.expect_strangers_command();
    }
    robot.deliver();
    if (i % 4 == 3) {
      robot.tick(utime);
    }
  }
  robot.tick(utime + 1'000'000);
  return 0;
}
