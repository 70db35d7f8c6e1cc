// A client that sends 10,000 malformed requests: none of them crashes the viewer or becomes a message that moves the
// robot. A stop may come out of it: whatever is not clearly a release of the stop is a stop.

#include "services/viewer/http/http_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <random>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

// The client's library writes to sockets that the server has closed, which would end the test.
[[maybe_unused]] const auto kIgnoresClosedSockets = std::signal(SIGPIPE, SIG_IGN);

constexpr int kRequests = 10'000;
constexpr int kClients = 8;

class Mutator {
 public:
  explicit Mutator(unsigned seed) : rng_(seed) {}

  // Bytes that look like a request and are none that may be obeyed.
  std::string next() {
    constexpr std::array kPaths = {"goal", "motors", "initial_pose", "map", "steering", "process"};
    const std::string path = kPaths[below(kPaths.size())];
    const std::string body = broken(body_of(path));
    std::string head = "POST /api/" + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n" +
                       "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n";
    switch (below(6)) {
      case 0:  // one letter becomes another
        head[below(head.size())] = static_cast<char>(below(256));
        return head + body;
      case 1:  // cut short
        return (head + body).substr(0, 1 + below(head.size() + body.size() - 1));
      case 2:  // noise
        return noise(1 + below(300));
      case 3:  // lies about its length
        return "POST /api/" + path +
               " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: " + lie() +
               "\r\n\r\n" + body;
      case 4:  // a foreign host, page or path
        return foreign(path);
      default:
        return head + body;
    }
  }

 private:
  std::size_t below(std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(rng_); }

  std::string noise(std::size_t size) {
    std::string bytes(size, ' ');
    for (char& byte : bytes) {
      byte = static_cast<char>(below(256));
    }
    return bytes;
  }

  static std::string body_of(std::string_view path) {
    if (path == "goal") return R"({"action":"go","poses":[{"x":1.0,"y":2.0,"theta":0.5}],"loop":false})";
    if (path == "motors") return R"({"enable":true})";
    if (path == "initial_pose") return R"({"x":1.0,"y":2.0,"theta":0.5})";
    if (path == "map") return R"({"action":"save"})";
    if (path == "steering") return R"({"session":1,"sequence":1,"linear":0.1,"angular":0.1,"seen":1})";
    return R"({"name":"mapper","action":"restart"})";
  }

  // No longer what it was: without its end, with a key or a type too many, with bytes that are no text.
  std::string broken(std::string body) {
    switch (below(6)) {
      case 0:
        return body.substr(0, below(body.size()));
      case 1:
        return body.replace(body.find('"') + 1, 1, noise(1 + below(8)) + "\x01");
      case 2:
        return "[" + body + "]";
      case 3:
        return body.replace(body.find(':') + 1, 0, "{\"deep\":[[[[[[[[[[[[");
      case 4:
        return body.insert(1, R"("unknown":1e999,)");
      default:
        return noise(below(2'000)) + "}";
    }
  }

  std::string lie() {
    constexpr std::array kLies = {"-1", "99999999999999999999", "0x10", "18446744073709551615", "1e3", "", "70000"};
    return kLies[below(kLies.size())];
  }

  std::string foreign(const std::string& path) {
    const std::string body = body_of(path);  // a good one, but from where it may not come
    const std::string length =
        "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n";
    switch (below(4)) {
      case 0:
        return "POST /api/" + path + " HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n" + length + body;
      case 1:
        return "POST /api/" + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: http://evil.example\r\n" + length + body;
      case 2:
        return "POST /api/../api/" + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n" + length + body;
      default:
        return "GET /../../../../etc/passwd HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n";
    }
  }

  std::mt19937 rng_;
};

// Sends bytes, says that no more come, and reads what the other side has to say.
std::string exchange(int port, const std::string& bytes) {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  std::string answer;
  if (connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0) {
    send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    shutdown(descriptor, SHUT_WR);
    std::array<char, 4096> buffer{};
    for (ssize_t count = 0; (count = recv(descriptor, buffer.data(), buffer.size(), 0)) > 0;) {
      answer.append(buffer.data(), static_cast<std::size_t>(count));
    }
  }
  close(descriptor);
  return answer;
}

class HttpFuzzTest : public ::testing::Test {
 protected:
  HttpFuzzTest() {
    HttpOptions options;
    options.port = options.command_port = 0;
    server_ = std::make_unique<HttpServer>(
        options, HttpServer::Context{board_, pictures_, desk_, helm_, processes_, clock_, building_, robot_});
    robot_status_t status{};
    status.utime = 1;
    helm_.on_robot_status(status);
  }

  // Counts what was published on the bus that the viewer moves the robot by.
  int published() {
    int count = 0;
    while (lcm_.handleTimeout(0) > 0) {
      ++count;
    }
    return count;
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
  std::unique_ptr<HttpServer> server_;
};

void ignore(const lcm::ReceiveBuffer*, const std::string&, void*) {}

TEST_F(HttpFuzzTest, TenThousandMalformedRequestsDoNothing) {
  for (const char* channel : {channels::kGoal, channels::kMotorsCommand, channels::kInitialPose, channels::kMapCommand,
                              channels::kTeleopCommand, channels::kVelocityCommand}) {
    lcm_.subscribeFunction(channel, &ignore, static_cast<void*>(nullptr));
  }
  std::vector<std::thread> clients;
  std::array<int, kClients> accepted{}, leaked{};
  for (int client = 0; client < kClients; ++client) {
    clients.emplace_back([&, client] {
      Mutator mutator(static_cast<unsigned>(42 + client));
      for (int i = 0; i < kRequests / kClients; ++i) {
        const std::string answer = exchange(i % 2 == 0 ? server_->command_port() : server_->port(), mutator.next());
        accepted[static_cast<std::size_t>(client)] += answer.find("{\"id\":") != std::string::npos ? 1 : 0;
        leaked[static_cast<std::size_t>(client)] += answer.find("root:") != std::string::npos ? 1 : 0;
      }
    });
  }
  for (std::thread& client : clients) {
    client.join();
  }
  for (int client = 0; client < kClients; ++client) {
    EXPECT_EQ(accepted[static_cast<std::size_t>(client)], 0) << "client " << client;
    EXPECT_EQ(leaked[static_cast<std::size_t>(client)], 0) << "client " << client;
  }
  EXPECT_EQ(published(), 0);

  httplib::Client after("127.0.0.1", server_->port());
  EXPECT_EQ(after.Get("/")->status, 200);
  httplib::Client commands("127.0.0.1", server_->command_port());
  EXPECT_EQ(commands.Post("/api/motors", R"({"enable":true})", "application/json")->status, 200);
  EXPECT_EQ(published(), 1) << "what is good still goes through";
}

}  // namespace
}  // namespace luminav
