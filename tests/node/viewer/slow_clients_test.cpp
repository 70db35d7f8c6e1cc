// Clients that hang on: those that send a byte now and then, those that never come to an end, those that never read.
// None of them keeps a STOP waiting or makes the viewer grow.

#include "services/viewer/http/http_server.hpp"  // Eigen before httplib: resolv.h has a macro of a name that it uses

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

int connect_to(int port) {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (connect(client, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    close(client);
    return -1;
  }
  return client;
}

/// False when the other side has hung up.
bool send_some(int client, const std::string& bytes) {
  const ssize_t count = send(client, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return count >= 0 || errno == EAGAIN;
}

/// Connections that go on sending, in a thread of their own, and come again when they are thrown out.
class Crowd {
 public:
  Crowd(int port, int count, std::string first, std::string then, int pause_ms)
      : first_(std::move(first)), then_(std::move(then)) {
    for (int i = 0; i < count; ++i) {
      clients_.push_back(connect_to(port));
      send_some(clients_.back(), first_);
    }
    thread_ = std::thread([this, port, pause_ms] {
      while (!is_over_) {
        for (int& client : clients_) {
          if (!send_some(client, then_)) {
            close(client);
            client = connect_to(port);
            send_some(client, first_);
          }
        }
        poll(nullptr, 0, pause_ms);
      }
    });
  }
  ~Crowd() {
    is_over_ = true;
    thread_.join();
    for (const int client : clients_) {
      close(client);
    }
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

 private:
  std::string first_, then_;
  std::vector<int> clients_;
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

class SlowClientsTest : public ::testing::Test {
 protected:
  SlowClientsTest() : subscriber_(lcm_) {
    subscriber_.on(channels::kStop, &SlowClientsTest::on_stop, this);
    HttpOptions options;
    options.port = options.command_port = 0;
    options.tokens.administer = "secret";
    server_ = std::make_unique<HttpServer>(
        options, HttpServer::Context{board_, pictures_, desk_, helm_, processes_, clock_, building_, robot_});
  }
  void on_stop(const stop_t&) { ++stops_; }
  /// As the page does: a connection of its own, and again when that had to give way to another before it had spoken.
  static testing::AssertionResult stops_through(int port) {
    httplib::Client client("127.0.0.1", port);
    client.set_connection_timeout(5);
    client.set_read_timeout(5);
    const auto begin = std::chrono::steady_clock::now();
    constexpr int kAttempts = 5;
    httplib::Result answer = client.Post("/api/stop", R"({"engaged":true})", "text/plain");
    for (int attempt = 1; attempt < kAttempts && !answer; ++attempt) {
      answer = client.Post("/api/stop", R"({"engaged":true})", "text/plain");
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    testing::Test::RecordProperty("stop_seconds", std::to_string(seconds));
    slowest_ = std::max(slowest_, seconds);
    return answer && answer->status == 200 ? testing::AssertionSuccess()
                                           : testing::AssertionFailure() << "no answer after " << seconds << " s";
  }
  /// True when the server hangs up before it was sent as much as that.
  static bool is_cut_off(int port, const std::string& first, const std::string& then) {
    constexpr std::size_t kMuch = 64 * 1024 * 1024;  // [bytes]
    const int client = connect_to(port);
    bool is_cut = !send_some(client, first);
    for (std::size_t sent = 0; sent < kMuch && !is_cut;) {
      pollfd writable{client, POLLOUT, 0};
      constexpr int kPatience = 10'000;  // [ms] a server that takes nothing more and does not hang up
      if (poll(&writable, 1, kPatience) <= 0) {
        break;
      }
      const ssize_t count = send(client, then.data(), then.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
      is_cut = count < 0 && errno != EAGAIN;
      sent += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
    close(client);
    return is_cut;
  }

  lcm::LCM lcm_{"memq://"};
  lcm::LCM procman_{"memq://"};
  VirtualClock clock_;
  SnapshotBoard board_;
  PictureStore pictures_;
  RequestDesk desk_{lcm_, "viewer@desk"};
  Helm helm_{lcm_, {}};
  ProcessDesk processes_{procman_, lcm_};
  Building building_;
  RobotDescription robot_;
  Subscriber subscriber_;
  std::unique_ptr<HttpServer> server_;
  int stops_ = 0;
  static double slowest_;  // [s]
};

double SlowClientsTest::slowest_ = 0.0;

TEST_F(SlowClientsTest, AStopGetsThroughFiveHundredSlowAndAHundredEndlessOnes) {
  const std::string kSlow = "POST /api/stop HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ";
  for (const int port : {server_->command_port(), server_->port()}) {
    const Crowd slow(port, 500, kSlow, "x", 50);
    const Crowd endless(port, 100, "GET /", std::string(16'384, 'x'), 1);
    for (int i = 0; i < 20; ++i) {
      EXPECT_TRUE(stops_through(server_->command_port()));
      EXPECT_TRUE(stops_through(server_->port()));
    }
  }
  std::printf("the slowest STOP took %.3f s\n", slowest_);
  while (lcm_.handleTimeout(0) > 0) {
  }
  EXPECT_GE(stops_, 80);  // more where an answer was cut off
}

TEST_F(SlowClientsTest, AStopGetsThroughThoseThatNeverRead) {
  board_.put(SnapshotBoard::Lane::kLive, "state", std::string(1'000'000, ' ') + "\n\n");
  const Crowd readers(server_->port(), 200, "GET /main.js HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n",
                      "GET /main.js HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 1);
  const Crowd listeners(server_->port(), 100, "GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", "x", 10);
  for (int i = 0; i < 20; ++i) {
    board_.tick();
    EXPECT_TRUE(stops_through(server_->port()));
  }
}

TEST_F(SlowClientsTest, NothingEndlessIsTakenIn) {
  const std::string host = "Host: 127.0.0.1\r\n";
  const std::string much(65'536, 'x');
  std::string headers;
  while (headers.size() < much.size()) {
    headers += "X-" + std::to_string(headers.size()) + ": y\r\n";
  }
  for (const int port : {server_->command_port(), server_->port()}) {
    EXPECT_TRUE(is_cut_off(port, "GET /", much)) << "line";
    EXPECT_TRUE(is_cut_off(port, "POST /api/goal HTTP/1.1\r\n" + host, headers)) << "headers";
    EXPECT_TRUE(is_cut_off(port, "POST /api/goal HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\n",
                           "10000\r\n" + much + "\r\n"))
        << "chunks";
    EXPECT_TRUE(is_cut_off(port, "POST /api/goal HTTP/1.1\r\n" + host + "Content-Length: 999999999999\r\n\r\n", much))
        << "body";
    EXPECT_TRUE(is_cut_off(
        port, "POST /api/goal HTTP/1.1\r\n" + host + "Content-Encoding: gzip\r\nContent-Length: 60000\r\n\r\n", much))
        << "compressed body";
  }
}

}  // namespace
}  // namespace luminav
