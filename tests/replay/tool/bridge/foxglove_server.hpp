#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/replay/tool/mcap/message_sink.hpp"

namespace luminav {

struct FoxgloveServerOptions {
  std::string listen = "127.0.0.1";
  int port = 8765;                       // 0 = any free one
  std::string host_name;                 // of this machine, for people on others
  std::vector<std::string> origins;      // of pages that may listen besides those of this machine
  std::vector<std::string> kept_topics;  // their last message is sent to whoever subscribes later
};

/// Serves messages by Foxglove's WebSocket protocol (subprotocols foxglove.websocket.v1 and foxglove.sdk.v1) to up to
/// 20 clients, who can only listen. A client that does not keep up loses messages, never the server: what waits for it
/// is bounded. Host and Origin are judged as the viewer does, so that no foreign page listens. Of one thread: nothing
/// happens but in `poll`.
class FoxgloveServer : public MessageSink {
 public:
  /// Throws std::runtime_error when the port cannot be had.
  explicit FoxgloveServer(const FoxgloveServerOptions& options);
  ~FoxgloveServer() override;
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  Channel add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema) override;
  void write(Channel channel, std::uint64_t log_time, std::uint64_t publish_time, std::string_view json) override;
  /// Takes and sends what can be without waiting.
  void poll();

  [[nodiscard]] int port() const;
  [[nodiscard]] std::size_t clients() const;
  /// Messages that slow clients did not get.
  [[nodiscard]] std::int64_t lost() const;

 private:
  class Session;
  struct Hub;
  std::unique_ptr<Hub> hub_;
};

}  // namespace luminav
