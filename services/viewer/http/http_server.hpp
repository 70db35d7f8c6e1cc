#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/process/clock.hpp"
#include "services/viewer/building/edit_desk.hpp"
#include "services/viewer/helm.hpp"
#include "services/viewer/http/http_rules.hpp"
#include "services/viewer/http/kept_files.hpp"
#include "services/viewer/picture_store.hpp"
#include "services/viewer/playback/log_player.hpp"
#include "services/viewer/process_desk.hpp"
#include "services/viewer/request_desk.hpp"
#include "services/viewer/snapshot_board.hpp"

namespace luminav {

struct HttpOptions {
  std::string listen = "127.0.0.1";
  int port = 8080;          // of the page; 0 = any free one
  int command_port = 8081;  // of the commands alone; 0 = any free one
  std::string host_name;    // of this machine, for people on others
  Tokens tokens;            // which role needs what; a STOP needs none
  std::string web_folder;   // reads the page from there instead of the built-in one; "" = built in
};

/// Two HTTP listeners with a thread each: one serves the page, the building, the camera's picture and the events, and
/// takes commands too; the other takes commands only. Whatever clients do, neither waits for them.
///
///   GET  /events              server-sent events, see ViewerNode; 503 when 40 clients listen, or ten of one machine
///   GET  /building.json, /settings.json, the page
///   GET  /qr.svg?text=TEXT    a QR code, for paper
///   GET  /camera.jpg[?sequence=N]  the newest picture, or that one; 404 when it is not there any more
///   GET  /api/..., /metrics   the newest of the events and the like, for programs
///   POST /api/goal, /api/stop, /api/motors, /api/initial_pose, /api/map, /api/survey, /api/steering,
///        /api/process
///                             JSON, see request_text.hpp; answers {"id": N}, or {"error": why} with 400 for what is
///                             none, 403 for who may not, 503 when the network takes nothing. A STOP needs no token,
///                             its release a driver's; map, process, files, building and tours need
///                             an administrator's.
///   GET  /api/file?kind=recording|map&name=NAME  one of the files that GET /api/files lists; POST there deletes one
///   GET, POST /api/building   zones and places, and edits of them, see building_order.hpp; 409 for an old version's
///   GET, POST /api/tours      stored tours, and edits of them, see tour_order.hpp
///   GET, POST /api/playback   the log that is shown, and how; 404 when it is a running robot. A log takes no other
///                             command: 403.
///   POST /api/watch           a person has the page in view; answers {"may_command": the token may drive}
///
/// web/openapi.json describes all of it but the page; a test compares it with `routes`.
class HttpServer {
 public:
  /// What is shown and where requests go. All must outlive the server.
  struct Context {
    SnapshotBoard& board;
    PictureStore& pictures;
    RequestDesk& desk;
    Helm& helm;
    ProcessDesk& processes;
    const Clock& clock;
    const Building& building;
    const RobotDescription& robot;
    LogPlayer* log = nullptr;  // which is shown instead of a running robot
    KeptFiles files = {};
    BuildingDesk* site = nullptr;  // takes edits of the building, which it then has; none: `building` stays as it is
    TourDesk* tours = nullptr;     // takes edits of the stored tours
  };

  /// Binds both ports and starts to serve; throws std::runtime_error when one of them is taken.
  HttpServer(const HttpOptions& options, const Context& context);
  /// Ends all connections and threads.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const;
  [[nodiscard]] int command_port() const;
  /// For a person to open; without the token.
  [[nodiscard]] std::string address() const;
  /// What is answered, the page's own files apart: "GET /api/state", ..., sorted.
  [[nodiscard]] std::vector<std::string> routes() const;

 private:
  struct Servers;
  std::unique_ptr<Servers> servers_;
};

}  // namespace luminav
