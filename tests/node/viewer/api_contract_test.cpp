#include "services/viewer/http/http_server.hpp"  // before httplib.h, whose macros break Eigen

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "services/viewer/http/web_files.hpp"

namespace luminav {
namespace {

using ::testing::UnorderedElementsAreArray;
using Json = nlohmann::json;
using Statuses = std::set<int>;

const std::filesystem::path kBuilding = LUMINAV_SOURCE_DIR "/launch/buildings/laboratory/building.toml";

Json description() {
  for (const WebFile& file : web_files()) {
    if (file.name == "openapi.json") {
      return Json::parse(file.content);
    }
  }
  return {};
}

/// A viewer whose network takes nothing, and who has heard a robot.
class ApiContractTest : public ::testing::Test {
 protected:
  ApiContractTest() {
    options_.port = options_.command_port = 0;
    options_.tokens.administer = "secret";
    serve();
    robot_status_t status{};
    status.utime = 1;
    helm_.on_robot_status(status);
  }
  void serve() {
    const HttpServer::Context context{board_,    pictures_, desk_,   helm_, processes_,  clock_,
                                      building_, robot_,    nullptr, {},    site_.get(), tours_.get()};
    server_ = std::make_unique<HttpServer>(options_, context);
  }
  [[nodiscard]] httplib::Client client() const { return httplib::Client("127.0.0.1", server_->port()); }

  /// What a GET can be answered: before anything was heard, from elsewhere, and badly put.
  Statuses statuses_of_get(const std::string& path) {
    Statuses seen;
    const auto ask = [&](const httplib::Headers& headers) { seen.insert(client().Get(path, headers)->status); };
    if (path == "/events") {
      return {200, 400, 403, 431, 503};  // it has no end; its refusals are tried with slow clients
    }
    board_.clear(SnapshotBoard::Lane::kLive);
    board_.clear(SnapshotBoard::Lane::kAsked);
    seen.insert(client().Get(path + "?sequence=99")->status);  // which only the camera's picture heeds
    for (const char* subject :
         {"state", "nodes", "processes", "path", "hypotheses", "jobs", "survey", "building", "tours"}) {
      board_.put(SnapshotBoard::Lane::kLive, subject, server_sent_event(subject, "{}"));
    }
    board_.put(SnapshotBoard::Lane::kAsked, "metrics", "luminav_battery_volts 12\n");
    pictures_.put(1, "picture");
    ask({});
    ask({{"Host", "evil.example"}});
    ask({{"X-Luminav-Token", "a"}, {"X-Luminav-Token", "b"}});
    ask({{"X-Long", std::string(9000, 'x')}});
    if (path == "/api/file") {
      seen.insert(503);  // it takes one of the places of those without an end
    }
    return seen;
  }

  Statuses statuses_of_post(const std::string& path, const Json& operation) {
    Statuses seen;
    const auto ask = [&](const httplib::Headers& headers, const std::string& body, const char* type) {
      seen.insert(client().Post(path, headers, body, type)->status);
    };
    const httplib::Headers token = {{"X-Luminav-Token", "secret"}};
    const char* json = "application/json";
    ask({{"X-Luminav-Token", "secret"}, {"X-Luminav-Token", "b"}}, "{}", json);
    ask({{"Origin", "http://evil.example"}}, "{}", json);
    ask(token, std::string(20'000, ' '), json);
    ask({{"X-Long", std::string(9000, 'x')}}, "{}", json);
    seen.insert(client()
                    .Post(
                        path, token,
                        [](std::size_t, httplib::DataSink& sink) {
                          sink.done();
                          return true;
                        },
                        json)
                    ->status);
    ask(token, "{}", json);
    if (operation.contains("requestBody")) {
      for (Json example : operation.at("requestBody").at("content").at(json).at("examples")) {
        if (example["value"].contains("seen")) {
          example["value"]["seen"] = clock_.utime();
        }
        building_.places = {{"lab-door", {3.0, 7.0, 0.0}, true}};
        ask(token, example["value"].dump(), json);
      }
    }
    return seen;
  }

  lcm::LCM network_{"no-such-network://"};
  VirtualClock clock_;
  SnapshotBoard board_;
  PictureStore pictures_;
  RequestDesk desk_{network_, "viewer@desk"};
  Helm helm_{network_, {.linear = 1.0, .angular = 1.0}};
  lcm::LCM procman_{"memq://"};
  ProcessDesk processes_{procman_, procman_};
  Building building_;
  RobotDescription robot_;
  std::unique_ptr<BuildingDesk> site_;
  std::unique_ptr<TourDesk> tours_;
  HttpOptions options_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(ApiContractTest, EachPathOfTheServerStandsInTheDescriptionAndTheOtherWay) {
  std::vector<std::string> described;
  const Json all = description();
  for (const auto& [path, operations] : all["paths"].items()) {
    for (const auto& [method, operation] : operations.items()) {
      described.push_back((method == "get" ? "GET " : "POST ") + path);
    }
  }
  EXPECT_THAT(server_->routes(), UnorderedElementsAreArray(described));
}

TEST_F(ApiContractTest, EachErrorOfTheServerStandsInTheDescriptionAndTheOtherWay) {
  const Json all = description();
  ASSERT_FALSE(all["paths"].empty());
  // no example is for a version of it
  site_ = std::make_unique<BuildingDesk>(BuildingChanges(kBuilding, jobs_file_of(kBuilding)));
  tours_ = std::make_unique<TourDesk>(TourChanges(jobs_file_of(kBuilding), kBuilding));
  serve();
  for (const auto& [path, operations] : all["paths"].items()) {
    for (const auto& [method, operation] : operations.items()) {
      Statuses described;
      for (const auto& [status, response] : operation["responses"].items()) {
        described.insert(std::stoi(status));
      }
      Statuses seen = method == "get" ? statuses_of_get(path) : statuses_of_post(path, operation);
      seen.insert(200);  // what is answered then is compared with a robot that runs
      EXPECT_EQ(seen, described) << method << " " << path;
    }
  }
}

TEST_F(ApiContractTest, EachRoleMayWhatTheDescriptionSays) {
  const Json all = description();
  options_.tokens = {"owner", "driver", "guest"};
  serve();
  const std::vector<std::pair<std::string, int>> tokens = {{"", 0}, {"guest", 1}, {"driver", 2}, {"owner", 3}};
  const std::map<std::string, int> roles = {{"look", 1}, {"drive", 2}, {"administer", 3}};
  for (const auto& [path, operations] : all["paths"].items()) {
    for (const auto& [method, operation] : operations.items()) {
      // where none is named, looking; its first choice, nothing, is for viewers without a token to look
      const Json& named = operation.value("security", all["security"]);
      const int needed = named.empty() ? 0 : roles.at(named.back().at("token").at(0));
      for (const auto& [token, role] : tokens) {
        if (path == "/events" && role >= needed) {
          continue;  // it has no end
        }
        const httplib::Headers header = {{"X-Luminav-Token", token}};
        const auto answer =
            method == "get" ? client().Get(path, header) : client().Post(path, header, "{", "text/plain");
        const bool open = path == "/api/stop" || path == "/api/watch";  // whatever is no release is a stop
        EXPECT_EQ(answer->status == 403, !open && role < needed) << method << " " << path << " with " << token;
      }
    }
  }
  EXPECT_EQ(client().Post("/api/stop", {{"X-Luminav-Token", "guest"}}, R"({"engaged":false})", "text/plain")->status,
            403);
}

TEST_F(ApiContractTest, PagesLookByCookieAndCommandNothingByIt) {
  options_.tokens = {"owner", "", "guest"};
  serve();
  for (const char* token : {"owner", "guest"}) {
    const httplib::Headers cookie = {{"Cookie", std::string("a=b; luminav_token=") + token}};
    EXPECT_EQ(client().Get("/building.json", cookie)->status, 200);
    EXPECT_EQ(client().Post("/api/motors", cookie, R"({"enable":true})", "application/json")->status, 403);
  }
  EXPECT_EQ(client().Get("/building.json", {{"Cookie", "luminav_token=other"}})->status, 403);
  EXPECT_EQ(client().Get("/")->status, 200);  // the page itself tells nothing of the robot
}

TEST_F(ApiContractTest, GivesTheNewestOfEachSubjectAndTheWholeMap) {
  EXPECT_EQ(client().Get("/api/state")->status, 404);
  board_.put(SnapshotBoard::Lane::kLive, "state", server_sent_event("state", R"({"utime":1})"));
  board_.put(SnapshotBoard::Lane::kLive, "state", server_sent_event("state", R"({"utime":2})"));
  EXPECT_EQ(client().Get("/api/state")->body, R"({"utime":2})");
  board_.put(SnapshotBoard::Lane::kBulk, "tile 0 0", server_sent_event("tile", R"({"a":1})"));
  EXPECT_EQ(client().Get("/api/map")->body, R"({"tiles":[{"a":1}]})");
  board_.put(SnapshotBoard::Lane::kBulk, "tile 0 1", server_sent_event("tile", R"({"b":2})"));
  EXPECT_EQ(client().Get("/api/map")->body, R"({"tiles":[{"a":1}]})");  // of the same second
  clock_.advance(1'000'000);
  EXPECT_EQ(client().Get("/api/map")->body, R"({"tiles":[{"a":1},{"b":2}]})");
}

TEST_F(ApiContractTest, KeepsForeignPagesFromReading) {
  board_.put(SnapshotBoard::Lane::kLive, "state", server_sent_event("state", "{}"));
  EXPECT_FALSE(
      client().Get("/api/state", {{"Origin", "http://evil.example"}})->has_header("Access-Control-Allow-Origin"));
  EXPECT_EQ(httplib::Client("127.0.0.1", server_->command_port()).Get("/api/state")->status, 404);
}

}  // namespace
}  // namespace luminav
