#include "services/viewer/http/http_server.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <luminav/supervision_t.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

// The client's library writes to sockets that the server has closed, which would end the test.
[[maybe_unused]] const auto kIgnoresClosedSockets = std::signal(SIGPIPE, SIG_IGN);

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class HttpServerTest : public ::testing::Test {
 protected:
  explicit HttpServerTest(const std::string& token = "") : subscriber_(lcm_) {
    building_.name = "hut";
    HttpOptions options;
    options.port = options.command_port = 0;
    options.host_name = "robot";
    options.tokens.administer = token;
    server_ = std::make_unique<HttpServer>(options, context());
    subscriber_.on(channels::kGoal, &HttpServerTest::on_goal, this);
    subscriber_.on(channels::kStop, &HttpServerTest::on_stop, this);
    subscriber_.on(channels::kSupervision, &HttpServerTest::on_supervision, this);
  }
  HttpServer::Context context() { return {board_, pictures_, desk_, helm_, processes_, clock_, building_, robot_}; }
  void on_goal(const goal_t& message) { goals_.push_back(message); }
  void on_supervision(const supervision_t& message) { watched_ += message.sender == "viewer@desk" ? 1 : 0; }
  void on_stop(const stop_t& message) { stops_.push_back(message); }
  void deliver() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  [[nodiscard]] httplib::Client page() const { return httplib::Client("127.0.0.1", server_->port()); }
  [[nodiscard]] httplib::Client commands() const { return httplib::Client("127.0.0.1", server_->command_port()); }
  [[nodiscard]] std::string origin() const { return "http://127.0.0.1:" + std::to_string(server_->port()); }

  lcm::LCM lcm_{"memq://"};
  VirtualClock clock_;
  SnapshotBoard board_;
  PictureStore pictures_;
  RequestDesk desk_{lcm_, "viewer@desk"};
  Helm helm_{lcm_, {}};
  lcm::LCM procman_{"memq://"};
  ProcessDesk processes_{procman_, lcm_};
  Building building_;
  RobotDescription robot_;
  Subscriber subscriber_;
  std::vector<goal_t> goals_;
  std::vector<stop_t> stops_;
  int watched_ = 0;
  std::unique_ptr<HttpServer> server_;
};

constexpr const char* kJson = "application/json";
const std::string kGo = R"({"action":"go","poses":[{"x":1,"y":2}]})";

TEST_F(HttpServerTest, ServesThePageAndWhatItNeeds) {
  const auto index = page().Get("/");
  ASSERT_TRUE(index);
  EXPECT_EQ(index->status, 200);
  EXPECT_THAT(index->body, HasSubstr("STOP"));
  EXPECT_EQ(index->get_header_value("X-Frame-Options"), "DENY");
  const auto script = page().Get("/main.js");
  ASSERT_TRUE(script);
  EXPECT_THAT(script->get_header_value("Content-Type"), HasSubstr("javascript"));
  EXPECT_EQ(Json::parse(page().Get("/building.json")->body)["name"], "hut");
  EXPECT_EQ(Json::parse(page().Get("/settings.json")->body)["command_port"], server_->command_port());
  EXPECT_EQ(page().Get("/camera.jpg")->status, 404);
  pictures_.put(7, "picture");
  EXPECT_EQ(page().Get("/camera.jpg")->body, "picture");
}

TEST_F(HttpServerTest, GivesThePictureThatIsMeantOrNone) {
  for (const int sequence : {6, 7, 8, 9}) {
    pictures_.put(sequence, "picture " + std::to_string(sequence));
  }
  EXPECT_EQ(page().Get("/camera.jpg")->body, "picture 9");
  EXPECT_EQ(page().Get("/camera.jpg?sequence=8")->body, "picture 8");
  EXPECT_EQ(page().Get("/camera.jpg?sequence=7")->body, "picture 7");
  for (const char* missing : {"6", "10", "-1", "", "8x", "99999999999999"}) {
    EXPECT_EQ(page().Get(std::string("/camera.jpg?sequence=") + missing)->status, 404) << missing;
  }
}

TEST_F(HttpServerTest, ALogTakesNoCommandButItsOwn) {
  EXPECT_EQ(page().Get("/api/playback")->status, 404);
  LogPlayer log(LUMINAV_SOURCE_DIR "/tests/replay/logs/global.lcm");
  HttpServer::Context shown = context();
  shown.log = &log;
  HttpOptions options;
  options.port = options.command_port = 0;
  server_ = std::make_unique<HttpServer>(options, shown);
  for (const char* path : {"/api/goal", "/api/stop", "/api/steering", "/api/process", "/api/watch"}) {
    const auto answer = page().Post(path, kGo, kJson);
    EXPECT_EQ(answer->status, 403) << path;
    EXPECT_THAT(answer->body, HasSubstr("no robot hears it"));
  }
  deliver();
  EXPECT_TRUE(goals_.empty());
  EXPECT_EQ(commands().Post("/api/playback", R"({"playing":true,"speed":2})", kJson)->status, 200);
  const Json state = Json::parse(page().Get("/api/playback")->body)["state"];
  EXPECT_EQ(state["file"], "global.lcm");
  EXPECT_EQ(state["playing"], true);
  EXPECT_EQ(state["speed"], 2);
  for (const char* wrong : {"{}", R"({"speed":17})", R"({"speed":0.1})", R"({"position":-1})", R"({"playing":1})"}) {
    EXPECT_EQ(page().Post("/api/playback", wrong, kJson)->status, 400) << wrong;
  }
}

TEST_F(HttpServerTest, SendsALargeRecordingWholeAndDeletesItForWhoMay) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "http_server_recordings";
  std::filesystem::create_directories(folder);
  std::string content(5'000'000, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) {
    content[i] = static_cast<char>(i * 7 + i / 251);
  }
  std::ofstream(folder / "drive-1.lcm") << content;
  std::filesystem::last_write_time(folder / "drive-1.lcm",
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  HttpServer::Context shown = context();
  shown.files = KeptFiles(folder, folder / "p3dx", folder / "p3dx/photos");
  HttpOptions options;
  options.port = options.command_port = 0;
  options.tokens.administer = "secret";
  server_ = std::make_unique<HttpServer>(options, shown);
  const auto answer = page().Get("/api/file?kind=recording&name=drive-1.lcm");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->get_header_value("Content-Length"), "5000000");
  EXPECT_THAT(answer->get_header_value("Content-Disposition"), HasSubstr("drive-1.lcm"));
  EXPECT_TRUE(answer->body == content);
  EXPECT_EQ(page().Get("/api/file?kind=recording&name=../drive-1.lcm")->status, 404);
  const std::string order = R"({"action":"delete","kind":"recording","name":"drive-1.lcm"})";
  EXPECT_EQ(page().Post("/api/files", order, kJson)->status, 403);
  EXPECT_TRUE(std::filesystem::exists(folder / "drive-1.lcm"));
  EXPECT_EQ(page().Post("/api/files", {{"X-Luminav-Token", "secret"}}, order, kJson)->status, 200);
  EXPECT_EQ(Json::parse(page().Get("/api/files")->body)["recordings"].size(), 0U);
  std::filesystem::remove_all(folder);
}

TEST_F(HttpServerTest, NoPathLeadsOutOfThePage) {
  for (const char* path : {"/../main.cpp", "/..%2f..%2fetc%2fpasswd", "//etc/passwd", "/mainxjs", "/web/main.js"}) {
    EXPECT_EQ(page().Get(path)->status, 404) << path;
  }
}

TEST_F(HttpServerTest, TurnsRequestsIntoMessages) {
  const auto answer = commands().Post("/api/goal", {{"Origin", origin()}}, kGo, kJson);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->get_header_value("Access-Control-Allow-Origin"), origin());
  deliver();
  ASSERT_EQ(goals_.size(), 1U);
  EXPECT_EQ(goals_[0].id, Json::parse(answer->body)["id"]);
  EXPECT_DOUBLE_EQ(goals_[0].poses[0].y, 2.0);
  EXPECT_EQ(page().Post("/api/stop", R"({"engaged":true})", "text/plain")->status, 200);  // the page's port as well
  deliver();
  ASSERT_EQ(stops_.size(), 1U);
  EXPECT_TRUE(stops_[0].engaged);
}

TEST_F(HttpServerTest, RefusesForeignPagesNamesAndTypes) {
  EXPECT_EQ(commands().Post("/api/goal", {{"Origin", "http://evil.example"}}, kGo, kJson)->status, 403);
  EXPECT_EQ(commands().Post("/api/goal", {{"Host", "evil.example"}}, kGo, kJson)->status, 403);
  EXPECT_EQ(commands().Post("/api/goal", kGo, "text/plain")->status, 415);
  EXPECT_EQ(commands().Post("/api/goal", R"({"action":"go"})", kJson)->status, 400);
  EXPECT_EQ(commands().Post("/api/stop", {{"Origin", "http://evil.example"}}, "", "text/plain")->status, 403);
  EXPECT_EQ(page().Get("/events", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(commands().Get("/api/goal")->status, 405);
  const auto preflight = commands().Options("/api/goal", {{"Origin", "http://evil.example"}});
  EXPECT_FALSE(preflight->has_header("Access-Control-Allow-Origin"));
  deliver();
  EXPECT_TRUE(goals_.empty());
  EXPECT_TRUE(stops_.empty());
}

TEST_F(HttpServerTest, RefusesHugeRequests) {
  const auto answer = commands().Post("/api/goal", std::string(1 << 20, ' '), kJson);
  EXPECT_TRUE(!answer || answer->status == 413);
  deliver();
  EXPECT_TRUE(goals_.empty());
}

class GuardedHttpServerTest : public HttpServerTest {
 protected:
  GuardedHttpServerTest() : HttpServerTest("secret") {}
};

TEST_F(GuardedHttpServerTest, DemandsTheTokenForEverythingThatMovesTheRobot) {
  EXPECT_EQ(commands().Post("/api/goal", kGo, kJson)->status, 403);
  EXPECT_EQ(commands().Post("/api/goal", {{"X-Luminav-Token", "wrong"}}, kGo, kJson)->status, 403);
  EXPECT_EQ(page().Post("/api/motors", R"({"enable":true})", kJson)->status, 403);
  EXPECT_EQ(commands().Post("/api/goal", {{"X-Luminav-Token", "secret"}}, kGo, kJson)->status, 200);
  EXPECT_EQ(page().Get("/building.json")->status, 200);  // looking is free
  EXPECT_THAT(server_->address(), Not(HasSubstr("secret")));
  deliver();
  EXPECT_EQ(goals_.size(), 1U);
}

TEST_F(GuardedHttpServerTest, ObeysAStopWithoutTheTokenButNoRelease) {
  EXPECT_EQ(commands().Post("/api/stop", R"({"engaged":true})", "text/plain")->status, 200);
  EXPECT_EQ(page().Post("/api/stop", "", "text/plain")->status, 200);
  EXPECT_EQ(page().Post("/api/stop", R"({"engaged":false})", kJson)->status, 403);
  EXPECT_EQ(commands().Post("/api/stop", {{"X-Luminav-Token", "secre"}}, R"({"engaged":false})", kJson)->status, 403);
  EXPECT_EQ(commands().Post("/api/stop", {{"Origin", "http://evil.example"}}, "", "text/plain")->status, 403);
  deliver();
  ASSERT_EQ(stops_.size(), 2U);
  EXPECT_TRUE(stops_[0].engaged && stops_[1].engaged);
  EXPECT_EQ(commands().Post("/api/stop", {{"X-Luminav-Token", "secret"}}, R"({"engaged":false})", kJson)->status, 200);
}

TEST_F(GuardedHttpServerTest, TellsAPageInViewWhatItMayAndTheRobotThatSomebodyWatches) {
  EXPECT_EQ(page().Post("/api/watch", "", "text/plain")->body, R"({"may_command":false})");
  clock_.advance(1'000'000);
  EXPECT_EQ(commands().Post("/api/watch", {{"X-Luminav-Token", "secret"}}, "", "text/plain")->body,
            R"({"may_command":true})");
  EXPECT_EQ(page().Post("/api/watch", {{"Origin", "http://evil.example"}}, "", "text/plain")->status, 403);
  deliver();
  EXPECT_EQ(watched_, 2);
}

TEST_F(HttpServerTest, SaysWhenAStopCouldNotBeSent) {
  lcm::LCM network("no-such-network://");
  RequestDesk desk(network, "viewer@desk");
  HttpOptions options;
  options.port = options.command_port = 0;
  SnapshotBoard board;
  const HttpServer server(options, {board, pictures_, desk, helm_, processes_, clock_, building_, robot_});
  httplib::Client client("127.0.0.1", server.command_port());
  const auto answer = client.Post("/api/stop", "", "text/plain");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 503);
  EXPECT_THAT(answer->body, HasSubstr("not sent"));
}

// A client that asks for the events and reads them only when it is told to.
class EventReader {
 public:
  explicit EventReader(int port, const std::string& header = "") : descriptor_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const std::string request = "GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n" + header + "\r\n";
    is_connected_ = connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0 &&
                    send(descriptor_, request.data(), request.size(), MSG_NOSIGNAL) > 0;
  }
  ~EventReader() { close(descriptor_); }
  EventReader(const EventReader&) = delete;
  EventReader& operator=(const EventReader&) = delete;
  /// All that came, once it holds `text`; what came until the connection ended if it never does.
  [[nodiscard]] std::string read_until(const std::string& text) const {
    std::string received;
    std::array<char, 4096> bytes;
    for (ssize_t count = 1; count > 0 && received.find(text) == std::string::npos;) {
      count = recv(descriptor_, bytes.data(), bytes.size(), 0);
      received.append(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(0, count)));
    }
    return received;
  }
  [[nodiscard]] bool is_connected() const { return is_connected_; }

 private:
  int descriptor_;
  bool is_connected_ = false;
};

// Somebody who ticks as the viewer's loop does.
class Ticking {
 public:
  explicit Ticking(SnapshotBoard& board) {
    thread_ = std::thread([this, &board] {
      while (!is_over_) {
        board.put(SnapshotBoard::Lane::kLive, "state", "event: state\ndata: {}\n\n");
        board.tick();
        poll(nullptr, 0, 5);
      }
    });
  }
  ~Ticking() {
    is_over_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

TEST_F(HttpServerTest, StreamsNewsToItsReaders) {
  const Ticking ticking(board_);
  const EventReader reader(server_->port());
  const std::string received = reader.read_until("\n\nevent: state\ndata: {}\n\n");
  EXPECT_THAT(received, HasSubstr("Content-Type: text/event-stream\r\n"));
  EXPECT_THAT(received, HasSubstr("\r\n\r\nretry: "));
  EXPECT_THAT(received, HasSubstr("\n\nevent: state\ndata: {}\n\n"));
}

TEST_F(HttpServerTest, StreamsToAReaderThatWantsNoSecondAnswer) {
  const Ticking ticking(board_);
  const EventReader reader(server_->port(), "Connection: close\r\n");  // as Python's urllib
  const std::string twice = "event: state\ndata: {}\n\nevent: state\ndata: {}\n\n";
  EXPECT_THAT(reader.read_until(twice), HasSubstr(twice));
}

TEST_F(HttpServerTest, ManyStalledReadersHoldUpNobody) {
  std::vector<std::unique_ptr<EventReader>> readers;
  for (int i = 0; i < 20; ++i) {
    readers.push_back(std::make_unique<EventReader>(server_->port()));
    ASSERT_TRUE(readers.back()->is_connected());
  }
  for (int round = 0; round < 50; ++round) {  // far more than their sockets hold
    board_.put(SnapshotBoard::Lane::kLive, "state", std::string(100'000, ' ') + "\n\n");
    board_.tick();
    EXPECT_EQ(page().Get("/settings.json")->status, 200);
  }
  EXPECT_EQ(commands().Post("/api/stop", "", "text/plain")->status, 200);
  deliver();
  EXPECT_EQ(stops_.size(), 1U);
  board_.clear(SnapshotBoard::Lane::kLive);
  const Ticking ticking(board_);
  EXPECT_THAT(EventReader(server_->port()).read_until("event: state"), HasSubstr("event: state"));
}

TEST_F(HttpServerTest, TwoOnOnePortIsAnError) {
  HttpOptions options;
  options.port = server_->port();
  options.command_port = 0;
  SnapshotBoard board;
  EXPECT_THROW(
      HttpServer(options, HttpServer::Context{board, pictures_, desk_, helm_, processes_, clock_, building_, robot_}),
      std::runtime_error);
}

}  // namespace
}  // namespace luminav
