#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "services/common/building/map_file.hpp"
#include "services/common/calendar/local_time.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/replay/replay_run.hpp"
#include "tests/replay/tool/replay_picture.hpp"

namespace luminav {
namespace {

std::set<std::string> parse_nodes(const std::string& text) {
  std::set<std::string> nodes;
  std::istringstream stream(text);
  for (std::string node; std::getline(stream, node, ',');) {
    nodes.insert(node);
  }
  return nodes;
}

ReplayTolerances parse_tolerances(const std::vector<std::string>& settings) {
  ReplayTolerances tolerances;
  double heading = degrees(tolerances.heading);
  double exact = 0.0;
  const std::map<std::string, double*> keys = {{"position", &tolerances.position},
                                               {"heading", &heading},
                                               {"wrong", &tolerances.wrong},
                                               {"localized", &tolerances.localized},
                                               {"tracking", &tolerances.tracking},
                                               {"map", &tolerances.map},
                                               {"exact", &exact}};
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const auto key = keys.find(setting.substr(0, equals));
    std::istringstream number(equals == std::string::npos ? "" : setting.substr(equals + 1));
    double value = 0.0;
    if (key == keys.end() || !(number >> value) || !number.eof() || value < 0.0) {
      throw ConfigurationError(fmt::format(
          "--tolerance {}: must be KEY=NUMBER with a number of at least 0 and KEY of position, heading, wrong, "
          "localized, tracking, map, exact",
          setting));
    }
    *key->second = value;
  }
  tolerances.heading = radians(heading);
  tolerances.exact = exact != 0.0;
  return tolerances;
}

std::uint64_t parse_seed(const std::string& text) {
  std::istringstream number(text);
  std::uint64_t value = 0;
  if (!(number >> value) || !number.eof()) {
    throw ConfigurationError(fmt::format("--seed {}: must be a whole number of at least 0", text));
  }
  return value;
}

std::int64_t parse_utc_offset(const std::string& text) {
  if (const std::optional<std::int64_t> offset = read_utc_offset(text)) {
    return *offset;
  }
  throw ConfigurationError(fmt::format("--utc-offset {}: must be as +0100", text));
}

void draw(const std::string& png_file, const ReplayOptions& options, const ReplayReport& report) {
  const Building building = read_building(options.building_file);
  if (building.map_file.empty()) {
    throw std::runtime_error("--picture: the building has no map to draw on");
  }
  draw_replay(png_file, read_map(building.map_file), building, report);
}

int replay(int argc, char** argv) {
  ReplayOptions options;
  std::vector<std::string> logs;
  std::string robot;
  std::string building;
  std::string nodes;
  std::string report_file;
  std::string picture;
  std::string seed;
  std::string offset = "+0000";  // whatever this machine's is: a log gives the same answers everywhere
  std::vector<std::string> tolerances;
  CommandLine line("replay",
                   "Feeds a recorded log to today's nodes, as fast as they go, and says how their answers differ.");
  line.positional("LOG", logs, "file that lcm-logger or scripts/record wrote", true)
      .robot_file(robot)
      .building_file(building)
      .text("--nodes", nodes,
            "of detector,localizer,mapper,planner,controller; default all for which the log has inputs")
      .text("--against", options.against_file, "log whose outputs to compare with; default those in LOG")
      .text("--answers", options.answers_file,
            "log of what processes answered while lcm-logplayer played LOG to them: judges that, runs no nodes")
      .output_file("--out", options.out_file, "write the outputs into this new log, with the inputs' time stamps")
      .flag("--keep-inputs", options.keep_inputs,
            "the new log holds inputs and truth too, so that it can be replayed itself")
      .output_file("--json,--report", report_file, "write the report as JSON there")
      .output_file("--png,--picture", picture,
                   "PNG: truth grey, recorded black, replayed green (particles, hypotheses) and blue (Kalman filter), "
                   "odometry magenta")
      .list("--tolerance", tolerances,
            "KEY=NUMBER, several times: position [m RMS], heading [deg RMS], wrong [s], localized [s later], tracking "
            "and map "
            "[share], exact=1 (same bytes as recorded)")
      .text("--seed", seed, "of the localizer; default its own")
      .text("--utc-offset", offset, "as +0100, of the time of day where the log was recorded: zones may have hours")
      .number("--shift-camera", options.camera_shift, "[m] spoils the detections on purpose, to see the verdict fail");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (logs.size() != 1) {
    throw ConfigurationError(fmt::format("found {} logs, must be one", logs.size()));
  }
  options.log_file = logs.front();
  options.robot_file = robot;
  options.building_file = building;
  options.nodes = parse_nodes(nodes);
  options.tolerances = parse_tolerances(tolerances);
  options.show_progress = isatty(STDERR_FILENO) != 0;
  if (!seed.empty()) {
    options.localizer_seed = parse_seed(seed);
  }
  options.utc_offset = parse_utc_offset(offset);
  if (!options.out_file.empty() && std::filesystem::exists(options.out_file) &&
      !is_written_in_place(options.out_file)) {
    throw std::runtime_error(fmt::format("{}: exists already, logs are never overwritten", options.out_file));
  }
  const ReplayReport report = replay_log(options);
  fmt::print("{}", to_text(report));  // first: a file that cannot be written must not cost the verdict
  std::fflush(stdout);
  if (!report_file.empty()) {
    write_whole_file(report_file, to_json(report, options));
  }
  if (!picture.empty()) {
    draw(picture, options, report);
  }
  return report.passed() ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("replay", [&] { return luminav::replay(argc, argv); });
}
