#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "tests/replay/log_reading/sample_message.hpp"

int main(int argc, char** argv) {
  using namespace luminav;
  return run_guarded("publish_samples", [&] {
    std::string url;
    bool list = false;
    CommandLine line("publish_samples",
                     "Publishes a message of every type again and again until it is ended, for tests of tools.");
    line.lcm_url(url).flag("--list", list, "only print the channels");
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    const MessageSchemas& schemas = MessageSchemas::built_in();
    if (list) {
      for (const auto& [name, type] : schemas.types()) {
        fmt::print("{}\n", sample_channel(type));
      }
      return 0;
    }
    const auto lcm = open_lcm(url);
    for (;;) {
      for (const auto& [name, type] : schemas.types()) {
        const std::vector<std::uint8_t> data = sample_message(schemas, type);
        lcm->publish(sample_channel(type), data.data(), static_cast<unsigned int>(data.size()));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return 0;
  });
}
