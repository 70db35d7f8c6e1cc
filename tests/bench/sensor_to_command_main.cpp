// From the middle of an image's exposure to what follows from it, read from a recorded drive.
#include <fmt/format.h>

#include <algorithm>
#include <lcm/lcm-cpp.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/pose_t.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"

namespace {

using namespace luminav;

/// Latencies [ms] of one stage, over the log.
struct Stage {
  const char* name = "";
  std::vector<double> latencies;
  [[nodiscard]] double percentile(double share) {
    std::sort(latencies.begin(), latencies.end());
    return latencies[static_cast<std::size_t>(share * static_cast<double>(latencies.size() - 1))];
  }
};

template <typename Message>
bool decode(const lcm::LogEvent& event, Message& message) {
  return message.decode(event.data, 0, event.datalen) >= 0;
}

/// Follows the newest image with sightings through the stages, each at the time when the logger heard of it.
std::vector<Stage> follow(const std::string& file) {
  lcm::LogFile log(file, "r");
  if (!log.good()) {
    throw std::runtime_error(fmt::format("{}: cannot be read", file));
  }
  std::vector<Stage> stages = {{"image_to_detections", {}}, {"image_to_pose", {}}, {"image_to_command", {}}};
  std::int64_t posed_image = 0;  // [us] of the newest image that a pose has used
  bool is_command_awaited = false;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel == channels::kFixtureDetections) {
      fixture_detections_t detections{};
      if (decode(*event, detections)) {
        stages[0].latencies.push_back(1e-3 * static_cast<double>(event->timestamp - detections.utime));
      }
    } else if (event->channel == channels::kPose) {
      pose_t pose{};
      if (decode(*event, pose) && pose.state == pose_t::STATE_TRACKING && pose.fixture_utime > posed_image) {
        posed_image = pose.fixture_utime;
        stages[1].latencies.push_back(1e-3 * static_cast<double>(event->timestamp - posed_image));
        is_command_awaited = true;
      }
    } else if (event->channel == channels::kVelocityCommand && is_command_awaited) {
      is_command_awaited = false;
      stages[2].latencies.push_back(1e-3 * static_cast<double>(event->timestamp - posed_image));
    }
  }
  return stages;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::string out;
  CommandLine line("sensor_to_command", "Latency from an image to the velocity command that follows from it.");
  line.positional("log", files, "recorded by demo --log", true)
      .output_file("--json", out, "write it as a benchmark does");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("sensor_to_command", [&] {
    nlohmann::ordered_json json = {{"context", nlohmann::ordered_json::object()},
                                   {"benchmarks", nlohmann::ordered_json::array()}};
    for (Stage& stage : follow(files.front())) {
      if (stage.latencies.empty()) {
        throw std::runtime_error(fmt::format("{}: has no {}", files.front(), stage.name));
      }
      fmt::print("{:<22} p50 {:6.1f} ms  p99 {:6.1f} ms  ({} times)\n", stage.name, stage.percentile(0.5),
                 stage.percentile(0.99), stage.latencies.size());
      json["benchmarks"].push_back({{"name", fmt::format("{}/real_time", stage.name)},
                                    {"real_time", stage.percentile(0.5)},
                                    {"time_unit", "ms"},
                                    {"p50_ms", stage.percentile(0.5)},
                                    {"p99_ms", stage.percentile(0.99)}});
    }
    if (!out.empty()) {
      write_whole_file(out, json.dump(2) + "\n");
    }
    return 0;
  });
}
