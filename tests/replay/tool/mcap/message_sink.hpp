#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace luminav {

/// Where JSON messages of named topics go: a file, or whoever listens.
class MessageSink {
 public:
  using Channel = std::uint16_t;

  virtual ~MessageSink() = default;
  /// Of one topic; schemas of one name are one. `schema` is a JSON Schema.
  virtual Channel add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema) = 0;
  /// Times [ns] since the epoch.
  virtual void write(Channel channel, std::uint64_t log_time, std::uint64_t publish_time, std::string_view json) = 0;
};

}  // namespace luminav
