#include <fmt/format.h>

#include <string>
#include <vector>

#include "services/common/process/command_line.hpp"
#include "tests/replay/log_reading/log_survey.hpp"
#include "tests/replay/log_reading/picture_trace.hpp"

int main(int argc, char** argv) {
  using namespace luminav;
  return run_guarded("loginfo", [&] {
    std::vector<std::string> files;
    CommandLine line(
        "loginfo",
        "Says what is in LCM logs: channels, types, rates, gaps, losses, latency and the path of pictures, "
        "and what would make a replay differ.");
    line.positional("LOG", files, "files that lcm-logger or scripts/record wrote", true);
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    for (const std::string& file : files) {
      LogReader log(file);
      LogSurvey survey;
      PictureTrace trace;
      LogEvent event;
      while (log.next(event)) {
        survey.add(event);
        trace.add(event);
      }
      fmt::print("{}: {}", file, survey.text());
      if (const std::string stages = trace.text(); !stages.empty()) {
        fmt::print("\n{}", stages);
      }
      if (!log.damage().empty()) {
        fmt::print("{}\n", log.damage());
      }
    }
    return 0;
  });
}
