#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/tours/jobs_file.hpp"
#include "services/launcher/network.hpp"
#include "services/viewer/address/page_addresses.hpp"
#include "services/viewer/address/qr_code.hpp"
#include "services/viewer/http/http_rules.hpp"
#include "services/viewer/http/http_server.hpp"
#include "services/viewer/http/metrics.hpp"
#include "services/viewer/http/token_file.hpp"
#include "services/viewer/playback/log_view.hpp"
#include "services/viewer/process_desk.hpp"
#include "services/viewer/viewer_node.hpp"

namespace luminav {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

/// A person reads it. A deputy's children have a terminal too, but each leads a session of its own there, and what they
/// print is kept and sent on.
bool is_read_by_a_person_alone() {
  return isatty(STDOUT_FILENO) != 0 && getsid(0) != getpid();
}

/// For a phone: by number, and to be photographed.
void say_where_others_reach_it(const HttpOptions& http, int port, const std::string& token) {
  std::string first;
  for (const std::string& address : reachable_addresses(http.listen)) {
    const std::string page = fmt::format("http://{}:{}/#token={}", address, port, token);
    fmt::print("viewer: or   {}\n", page);
    first = first.empty() ? page : first;
  }
  if (!first.empty()) {
    fmt::print("{}", qr_code(first));
  }
}

void say_address(const HttpOptions& http, const HttpServer& server, const std::filesystem::path& token_file) {
  const std::string address = server.address();
  const std::string& token = http.tokens.administer;
  const int port = server.port();
  if (token.empty()) {
    fmt::print("viewer: open {}\n", address);
  } else if (is_read_by_a_person_alone()) {
    // after the hash: browsers keep it to themselves
    fmt::print("viewer: open {}#token={}\n", address, token);
    say_where_others_reach_it(http, port, token);
  } else {
    fmt::print("viewer: open {}#token=TOKEN, with the token of {}\n", address, token_file.string());
  }
  std::fflush(stdout);
}

/// A viewer that cannot keep its token serves all the same: somebody may want to stop the robot.
std::string token_of(const std::filesystem::path& file) {
  try {
    return read_or_make_token(file);
  } catch (const ConfigurationError&) {
    throw;
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "viewer: {}; pages must be opened anew when it starts again\n", error.what());
    return random_hex(12);
  }
}

struct ViewerOptions {
  std::string robot_file;
  std::string building_file;
  std::string jobs_file;
  std::string url;
  std::string procman_url = launcher::default_procman_url();
  std::string log;              // shown instead of a running robot; "" = none
  std::filesystem::path state;  // recordings lie there, maps in the robot's folder in it
  std::filesystem::path token_file;
  HttpOptions http;
  ViewerConfig config;

  [[nodiscard]] KeptFiles files() const {
    return {state, state / config.robot.name, state / config.robot.name / "photos"};
  }
};

/// What both kinds of view have; the pages get it from the board.
struct Shown {
  SnapshotBoard board;
  PictureStore pictures;
};

void show_processes(Shown& shown, const ProcessDesk& processes) {
  shown.board.put(SnapshotBoard::Lane::kLive, "processes", server_sent_event("processes", processes.json()));
}

/// What was not put on the board before.
void show_news(Shown& shown, const std::string& subject, std::string json, std::string& before) {
  if (json != before) {
    shown.board.put(SnapshotBoard::Lane::kLive, subject, server_sent_event(subject, json));
    before = std::move(json);
  }
}

/// Why nobody may edit the building here and now; "" = he may.
std::string objection_to_edits(const EventLoop& loop, const ViewerNode& node, const std::string& host) {
  if (const std::string elsewhere = node.building_elsewhere(host); !elsewhere.empty()) {
    return fmt::format("{} has the building's file on its own machine: it is edited by hand, on both", elsewhere);
  }
  const std::string objection = loop.objection();
  return objection.empty() ? "" : "this page shows " + objection;
}

int view_robot(const ViewerOptions& options) {
  const HostClock clock;
  const ViewerConfig& config = options.config;
  const NetworkAccess access = read_network_access(options.robot_file);
  const LcmNetwork network = access.on(options.url);
  const auto lcm = open_lcm(network);
  const auto procman = open_lcm(access.on(options.procman_url));
  Shown shown;
  RequestDesk desk(*lcm, fmt::format("viewer@{}:{}-{}", options.http.host_name, getpid(), random_hex(4)), access.key);
  Helm helm(*lcm, config.robot.limits, access.key);
  ProcessDesk processes(*procman, *lcm, access.key);
  ViewerNode node(*lcm, config, clock, shown.board, shown.pictures, desk, helm);
  Metrics metrics(*lcm);
  BuildingDesk site(BuildingChanges(options.building_file, options.jobs_file));
  TourDesk tours(TourChanges(options.jobs_file, options.building_file));
  const HttpServer server(options.http, {shown.board, shown.pictures, desk, helm, processes, clock, config.building,
                                         config.robot, nullptr, options.files(), &site, &tours});
  say_address(options.http, server, options.token_file);

  EventLoop loop(*lcm, "viewer", config.robot.name, network);
  loop.belong_to(options.robot_file);
  loop.follow_building(options.building_file, [&](const Building&) {
    site.read_again();
    tours.read_again();
  });
  loop.report_health([&] { return node.health(); });
  std::string shown_site, shown_tours;
  loop.every(100'000, [&] {
    if (site.take_news()) {
      loop.building_has_changed();
    }
    const std::string objection = objection_to_edits(loop, node, options.http.host_name);
    const LocalTime now = local_time(clock.utime());
    site.object(objection);
    tours.object(objection);
    show_news(shown, "building", site.json(now), shown_site);
    show_news(shown, "tours", tours.json(now), shown_tours);
    node.show();
  });
  loop.every(200'000, [&] {
    desk.object(loop.objection());
    desk.repeat(clock.utime());
  });
  loop.watch([&] { return procman->getFileno(); },
             [&] {
               while (procman->handleTimeout(0) > 0) {
               }
             });
  loop.every(50'000, [&] { processes.tick(launcher::Instant::read()); });
  loop.every(1'000'000, [&] {
    tours.look();
    node.show_processes();
    show_processes(shown, processes);
    shown.board.put(SnapshotBoard::Lane::kAsked, "metrics", metrics.text(clock.utime()));
  });
  return loop.run();
}

// Joins no network at all.
int view_log(const ViewerOptions& options) {
  constexpr std::int64_t kLongestStep = 500'000;  // [us] a program that was stopped does not skip what it missed
  Shown shown;
  LogView view(options.log, options.config, shown.board, shown.pictures);
  lcm::LCM nobody("memq://");
  ProcessDesk processes(nobody, nobody);
  const HttpServer server(options.http,
                          {shown.board, shown.pictures, view.desk(), view.helm(), processes, view.clock(),
                           options.config.building, options.config.robot, &view.player(), options.files()});
  say_address(options.http, server, options.token_file);

  EventLoop loop(nobody, "viewer", options.config.robot.name);
  loop.report_health([&] { return view.health(); });
  const HostClock clock;
  std::int64_t last = clock.utime();
  loop.every(100'000, [&] {
    const std::int64_t now = clock.utime();
    view.advance(std::min(now - last, kLongestStep));
    last = now;
  });
  loop.every(1'000'000, [&] {
    view.show_processes();
    show_processes(shown, processes);
  });
  return loop.run();
}

int view(int argc, char** argv) {
  ViewerOptions options;
  HttpOptions& http = options.http;
  std::string state, token_file, drive_file, look_file;
  std::int64_t port = http.port;
  std::int64_t command_port = -1;
  CommandLine line("viewer", "Shows in any browser what the robot believes, and takes goals and stops.");
  line.robot_file(options.robot_file).building_file(options.building_file).lcm_url(options.url);
  line.text("--jobs", options.jobs_file,
            "the stored tours, as of the process jobs; default: jobs.toml beside the building's file");
  line.text("--listen", http.listen,
            "address to serve on; others than 127.0.0.1 reach beyond this machine and demand a token")
      .integer("--port", port, "of the page, 0 = any free one")
      .integer("--command-port", command_port, "of the commands alone (default: the next one)")
      .text("--log", options.log, "recorded log to show instead of a running robot; joins no network")
      .text("--procman-url", options.procman_url, "LCM network of deputies and sheriffs; default $LUMINAV_PROCMAN_URL")
      .state_folder(state)
      .text("--token-file", token_file, "file of this user that holds the token (default: STATE/ROBOT/viewer_token)")
      .text("--drive-token-file", drive_file,
            "a second token, for who may drive but not save maps, delete files or start processes; made if missing")
      .text("--look-token-file", look_file,
            "a third one, for who may only look: then looking needs a token, which it else does not; made if missing")
      .text("--web", http.web_folder, "folder to read the page from instead of the built-in one");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  command_port = command_port >= 0 ? command_port : (port == 0 ? 0 : port + 1);
  if (port < 0 || port > 65535 || command_port > 65535) {
    throw ConfigurationError("--port and --command-port must be 0 to 65535");
  }
  http.port = static_cast<int>(port);
  http.command_port = static_cast<int>(command_port);
  http.host_name = host_name();
  options.jobs_file = options.jobs_file.empty() ? jobs_file_of(options.building_file).string() : options.jobs_file;
  options.config = read_viewer_config(options.robot_file, options.building_file);
  options.state = state;
  options.token_file = token_file.empty() ? options.state / options.config.robot.name / "viewer_token"
                                          : std::filesystem::path(token_file);
  if (!is_loopback(http.listen)) {
    http.tokens.administer = token_of(options.token_file);
    http.tokens.drive = drive_file.empty() ? "" : read_or_make_token(drive_file);
    http.tokens.look = look_file.empty() ? "" : read_or_make_token(look_file);
  } else if (!drive_file.empty() || !look_file.empty()) {
    throw ConfigurationError(
        "--drive-token-file and --look-token-file need --listen: on 127.0.0.1 everybody may drive");
  }
  return options.log.empty() ? view_robot(options) : view_log(options);
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("viewer", [&] { return luminav::view(argc, argv); });
}
