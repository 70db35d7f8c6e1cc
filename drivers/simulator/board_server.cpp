#include "drivers/simulator/board_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace luminav {
namespace {

constexpr std::size_t kLongestBacklog = 65536;  // [bytes] a client that does not read loses its line

class TcpBoardServer final : public BoardServer {
 public:
  TcpBoardServer(BaseBoard& board, int port, bool all_addresses)
      : board_(board), listener_(listen_on(port, all_addresses)) {
    sockaddr_in bound{};
    socklen_t size = sizeof bound;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&bound), &size);
    port_ = ntohs(bound.sin_port);
  }
  TcpBoardServer(const TcpBoardServer&) = delete;
  TcpBoardServer& operator=(const TcpBoardServer&) = delete;
  ~TcpBoardServer() override {
    client_.reset();
    close(listener_);
  }

  void poll() override {
    accept_clients();
    const std::vector<std::uint8_t> output = board_.take_output();
    if (!client_) {
      return;  // as on a serial line, bytes for nobody are lost
    }
    backlog_.insert(backlog_.end(), output.begin(), output.end());
    receive();
    const std::vector<std::uint8_t> answers = board_.take_output();
    backlog_.insert(backlog_.end(), answers.begin(), answers.end());
    const std::size_t written = client_->write(backlog_);
    backlog_.erase(backlog_.begin(), backlog_.begin() + static_cast<std::ptrdiff_t>(written));
    if (!client_->is_open() || backlog_.size() > kLongestBacklog) {
      drop_client();
    }
  }

  [[nodiscard]] std::vector<int> descriptors() const override {
    return client_ ? std::vector{listener_, client_->descriptor()} : std::vector{listener_};
  }
  [[nodiscard]] bool has_client() const override { return client_ != nullptr; }
  [[nodiscard]] std::string address() const override { return "tcp:127.0.0.1:" + std::to_string(port_); }
  void set_unplugged(bool unplugged) override {
    unplugged_ = unplugged;
    if (unplugged) {
      drop_client();
    }
  }

 private:
  static int listen_on(int port, bool all_addresses) {
    const int listener = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(all_addresses ? INADDR_ANY : INADDR_LOOPBACK);
    if (bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(listener, 4) != 0) {
      const std::string why = std::strerror(errno);
      close(listener);
      throw std::runtime_error("port " + std::to_string(port) + ": " + why +
                               " (another simulator? choose one with --port)");
    }
    return listener;
  }

  void accept_clients() {
    while (true) {
      const int accepted = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (accepted < 0) {
        return;
      }
      if (client_ != nullptr && !client_->is_open()) {
        drop_client();
      }
      if (client_ != nullptr || unplugged_) {
        close(accepted);  // one robot, one client
        continue;
      }
      const int on = 1;
      setsockopt(accepted, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      client_ = std::make_unique<TcpStream>(accepted);
      backlog_.clear();
      board_.take_output();
    }
  }

  void receive() {
    std::array<std::uint8_t, 4096> bytes;
    constexpr int kMaxReads = 16;
    for (int i = 0; i < kMaxReads; ++i) {
      const std::size_t count = client_->read(bytes);
      board_.receive(std::span(bytes).first(count));
      if (count < bytes.size()) {
        return;
      }
    }
  }

  void drop_client() {
    if (client_ != nullptr) {
      client_.reset();
      backlog_.clear();
      board_.on_line_closed();
    }
  }

  BaseBoard& board_;
  int listener_;
  int port_ = 0;
  std::unique_ptr<TcpStream> client_;
  std::vector<std::uint8_t> backlog_;
  bool unplugged_ = false;
};

}  // namespace

std::unique_ptr<BoardServer> BoardServer::on_tcp(BaseBoard& board, int port, bool all_addresses) {
  return std::make_unique<TcpBoardServer>(board, port, all_addresses);
}

}  // namespace luminav
