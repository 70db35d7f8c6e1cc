#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/base/line/byte_stream.hpp"
#include "drivers/simulator/base_board.hpp"

namespace luminav {

/// Connects the controller of a simulated base with one client: over TCP, a pseudo terminal or any line. A client that
/// vanishes frees the place; the board notices only when its quirks say so, as a serial line does not tell.
class BoardServer {
 public:
  /// Listens on 127.0.0.1, or on all addresses when asked to. Port 0 lets the system choose. Throws
  /// std::runtime_error when the port is taken.
  static std::unique_ptr<BoardServer> on_tcp(BaseBoard& board, int port, bool all_addresses = false);
  /// A pseudo terminal; `link` (if not empty) is made a symbolic link to it. Bytes are garbled while the client's rate
  /// is not the board's.
  static std::unique_ptr<BoardServer> on_pty(BaseBoard& board, const std::string& link = "");

  virtual ~BoardServer() = default;
  /// Moves bytes both ways; never waits.
  virtual void poll() = 0;
  /// For ::poll(): readable when poll() has something to do.
  [[nodiscard]] virtual std::vector<int> descriptors() const = 0;
  [[nodiscard]] virtual bool has_client() const = 0;
  /// Where a client finds it: "tcp:127.0.0.1:8101" or the path of the terminal.
  [[nodiscard]] virtual std::string address() const = 0;
  /// Unplugged: clients are thrown out and nobody gets in (or the terminal stays mute) until plugged in again.
  virtual void set_unplugged(bool unplugged) = 0;
};

}  // namespace luminav
