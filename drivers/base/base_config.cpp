#include "drivers/base/base_config.hpp"

#include <stdexcept>

#include "drivers/base/line/byte_stream.hpp"

namespace luminav {

void check_base_config(const TomlTable& table, const BaseConfig& config, int baud) {
  if (config.supervised > 0.0 && config.supervised < 2.0) {
    table.fail("supervised", "must be 0 (off) or 2 to 600 s: a page speaks once a second");
  }
  try {
    stream_opener(config.device, baud);
  } catch (const std::invalid_argument& error) {
    table.fail("device", error.what());
  }
}

}  // namespace luminav
