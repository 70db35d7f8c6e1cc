#include "services/viewer/http/http_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "services/viewer/address/qr_code.hpp"
#include "services/viewer/http/http_listener.hpp"
#include "services/viewer/http/http_rules.hpp"
#include "services/viewer/http/query.hpp"
#include "services/viewer/http/readings.hpp"
#include "services/viewer/http/web_files.hpp"
#include "services/viewer/message_json.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {

std::string_view content_type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  if (name.ends_with(".json")) return "application/json";
  return "application/octet-stream";
}

namespace {

constexpr std::size_t kTilesPerTick = 18 * 1024;  // [bytes] of map per client and tenth of a second
constexpr std::string_view kCommandPrefix = "/api/";
constexpr std::string_view kTokenHeader = "x-luminav-token";
constexpr std::string_view kOnlyLog = "this page shows a recorded log: no robot hears it";
constexpr std::string_view kNoLog = "this page shows a running robot, not a log";
constexpr std::string_view kDescription = "openapi.json";  // of the interface: a file of the page, under another path

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

}  // namespace

struct HttpServer::Servers {
  /// What becomes of a command's body, and what is asked of the request besides Host and Origin.
  struct Command {
    std::function<std::int64_t(const std::string& body)> act;
    std::function<Role(const std::string& body)> role = [](const std::string&) { return Role::kDrive; };
    bool only_json = true;
  };

  Servers(const HttpOptions& the_options, const Context& the_context)
      : options(the_options),
        context(the_context),
        commands({.listen = options.listen, .port = options.command_port, .headers = headers(0)}),
        page({.listen = options.listen, .port = options.port, .headers = headers(commands.port())}) {
    rules.emplace(options.listen, options.host_name, page.port(), options.tokens);
    prepare_files();
    prepare_readings();
    prepare_commands();
    context.board.report_ticks([this] { page.wake(); });
    page.start([this](const HttpRequest& request) { return answer(request, true); });
    commands.start([this](const HttpRequest& request) { return answer(request, false); });
  }

  ~Servers() { context.board.report_ticks(nullptr); }

  // Every answer: no guessing of types, nothing from elsewhere, never inside a foreign page, where a click could be
  // stolen.
  static std::vector<std::pair<std::string, std::string>> headers(int command_port) {
    const std::string connect = command_port == 0 ? "'self'" : fmt::format("'self' *:{}", command_port);
    return {{"X-Content-Type-Options", "nosniff"},
            {"X-Frame-Options", "DENY"},
            {"Referrer-Policy", "no-referrer"},
            {"Cache-Control", "no-store"},
            {"Content-Security-Policy",
             fmt::format("default-src 'self'; img-src 'self' data: blob:; connect-src {}; frame-ancestors 'none'",
                         connect)}};
  }

  HttpResponse answer(const HttpRequest& request, bool is_page) {
    if (const auto objection = rules->objection_to_host(request.header("host"))) {
      return refusal(403, *objection);
    }
    const bool is_reading = is_page && (request.method == "GET" || request.method == "HEAD");
    const auto reading = is_reading ? readings.find(request.path) : readings.end();
    if (reading != readings.end() && !is_open(request.path)) {
      if (const auto objection = rules->objection_to_token(token_to_look(request), Role::kLook)) {
        return refusal(403, *objection);
      }
    }
    if (request.path.starts_with(kCommandPrefix)) {
      HttpResponse response = reading != readings.end() ? reading->second(request) : answer_command(request);
      allow_own_page(request, response);
      return response;
    }
    if (!is_page) {
      return refusal(404, "only commands are taken here");
    }
    if (request.method != "GET" && request.method != "HEAD") {
      return refusal(405, "only GET is answered here");
    }
    return reading != readings.end() ? reading->second(request) : file(request.path);
  }

  // What says how to ask, and nothing of the robot.
  static bool is_open(const std::string& path) { return path == "/settings.json" || path == "/api/openapi.json"; }

  // A page can put no header to pictures and events: it has a cookie. Commands never heed that, so that no other site
  // makes a browser send one.
  static std::string_view token_to_look(const HttpRequest& request) {
    const std::string_view header = request.header(kTokenHeader);
    return header.empty() ? read_cookie(request.header("cookie"), "luminav_token") : header;
  }

  void prepare_readings() {
    readings = board_readings(context.board, context.clock, [this] { return building(); });
    readings["/events"] = [this](const HttpRequest&) { return events(); };
    readings["/camera.jpg"] = [this](const HttpRequest& request) { return picture(request.query); };
    readings["/building.json"] = [this](const HttpRequest&) {
      return text_answer(to_json(*building(), context.robot));
    };
    readings["/settings.json"] = [this](const HttpRequest& request) {
      return text_answer(fmt::format(
          R"({{"command_port":{},"needs_token":{},"needs_token_to_look":{},"role":"{}","robot":{},"shows_log":{}}})",
          commands.port(), !options.tokens.administer.empty(), !options.tokens.look.empty(),
          name_of(rules->role_of(request.header(kTokenHeader))), nlohmann::json(context.robot.name).dump(),
          context.log != nullptr));
    };
    readings["/qr.svg"] = [](const HttpRequest& request) { return code(request.query); };
    readings["/api/files"] = [this](const HttpRequest&) { return text_answer(context.files.json()); };
    readings["/api/file"] = [this](const HttpRequest& request) {
      return context.files.fetch(request.query).value_or(refusal(404, "there is no such file"));
    };
    readings["/api/playback"] = [this](const HttpRequest&) {
      return context.log != nullptr ? text_answer(context.log->json()) : refusal(404, kNoLog);
    };
    readings["/api/openapi.json"] = [this](const HttpRequest&) { return file(fmt::format("/{}", kDescription)); };
  }

  void prepare_files() {
    for (const WebFile& web_file : web_files()) {
      const std::string path = web_file.name == "index.html" ? "/" : fmt::format("/{}", web_file.name);
      files[path] = text_answer(std::string(web_file.content), content_type_of(web_file.name));
      names[path] = web_file.name;
    }
  }

  // Names from the built-in list only: no path gets out of a folder.
  [[nodiscard]] HttpResponse file(const std::string& path) const {
    const auto found = files.find(path);
    if (found == files.end()) {
      return refusal(404, "there is no such page");
    }
    const auto name = names.find(path);
    if (options.web_folder.empty() || name == names.end()) {
      return found->second;
    }
    return text_answer(read_file(fmt::format("{}/{}", options.web_folder, name->second)), found->second.type);
  }

  // What a page prints: text=... as a QR code.
  [[nodiscard]] static HttpResponse code(const std::string& query) {
    constexpr std::size_t kMaxText = 500;  // [bytes] of an address; phones read a larger code badly
    const std::optional<std::string> text = decoded(value_of(query, "text"));
    if (!text || text->empty() || text->size() > kMaxText) {
      return refusal(400, fmt::format("text: must be 1 to {} bytes", kMaxText));
    }
    return text_answer(qr_picture(*text), content_type_of(".svg"));
  }

  // With sequence=N that very one: what was found in it is drawn over it.
  [[nodiscard]] HttpResponse picture(const std::string& query) const {
    constexpr std::string_view kKey = "sequence=";
    const bool is_meant = query.starts_with(kKey);
    const PictureStore::Jpeg jpeg = is_meant ? find_picture(query.substr(kKey.size())) : context.pictures.newest();
    if (!jpeg) {
      return refusal(404, is_meant ? "this camera picture is not there, or not any more" : "no camera picture yet");
    }
    HttpResponse response;
    response.type = "image/jpeg";
    response.body = jpeg;
    return response;
  }

  [[nodiscard]] PictureStore::Jpeg find_picture(const std::string& sequence) const {
    std::int32_t number = 0;
    const auto [end, error] = std::from_chars(sequence.data(), sequence.data() + sequence.size(), number);
    const bool is_number = error == std::errc() && end == sequence.data() + sequence.size();
    return is_number ? context.pictures.find(number) : nullptr;
  }

  // A client that is slow to read skips what was replaced meanwhile.
  [[nodiscard]] HttpResponse events() const {
    HttpResponse response;
    response.type = "text/event-stream";
    response.sign_of_life = ": nothing new\n\n";
    response.more = [&board = context.board, cursor = context.board.new_reader(), is_first = true]() mutable {
      std::string batch = is_first ? "retry: 1000\n\n" : "";
      is_first = false;
      for (const SnapshotBoard::Text& text : board.read(cursor, kTilesPerTick)) {
        batch += *text;
      }
      return batch;
    };
    return response;
  }

  void prepare_commands() {
    const auto now = [this] { return context.clock.utime(); };
    actions["goal"].act = [this, now](const std::string& body) {
      return context.desk.send(read_goal_request(body, *building()), now());
    };
    // Taken in any dress and from anybody who is here: a stop must not fail for a header. A release is another thing.
    actions["stop"] = {
        .act = [this, now](const std::string& body) { return context.desk.send(read_stop_request(body), now()); },
        .role =
            [](const std::string& body) {
              return read_stop_request(body).engaged == 0 ? Role::kDrive : Role::kAnybody;
            },
        .only_json = false};
    actions["motors"].act = [this, now](const std::string& body) {
      return context.desk.send(read_motors_request(body), now());
    };
    actions["initial_pose"].act = [this, now](const std::string& body) {
      return context.desk.send(read_initial_pose_request(body), now());
    };
    actions["map"].act = [this, now](const std::string& body) {
      return context.desk.send(read_map_request(body), now());
    };
    actions["jobs"].act = [this, now](const std::string& body) {
      return context.desk.send(read_job_request(body, *building()), now());
    };
    actions["survey"].act = [this, now](const std::string& body) {
      return context.desk.send(read_survey_request(body), now());
    };
    actions["process"].act = [this, now](const std::string& body) {
      return context.processes.order(read_process_order(body), now());
    };
    actions["files"].act = [this](const std::string& body) {
      context.files.remove(read_file_order(body));
      return std::int64_t{0};
    };
    actions["playback"].act = [this](const std::string& body) {
      context.log->order(read_playback_order(body));
      return std::int64_t{0};
    };
    actions["building"].act = [this, now](const std::string& body) {
      if (context.site == nullptr) {
        throw RequestError("this viewer edits no building");
      }
      return context.site->order(read_building_order(body), now());
    };
    actions["tours"].act = [this, now](const std::string& body) {
      if (context.tours == nullptr) {
        throw RequestError("this viewer edits no tours");
      }
      return context.tours->order(read_tour_order(body), now());
    };
    for (const char* name : {"map", "process", "files", "building", "tours"}) {
      actions[name].role = [](const std::string&) { return Role::kAdminister; };
    }
    actions["steering"].act = [this, now](const std::string& body) {
      const Steering steering = read_steering(body);
      context.helm.steer(steering, now());
      return static_cast<std::int64_t>(steering.sequence);
    };
  }

  HttpResponse answer_command(const HttpRequest& request) {
    if (request.method == "OPTIONS") {
      return preflight();
    }
    const std::string name = request.path.substr(kCommandPrefix.size());
    if (context.log != nullptr && name != "playback") {
      return refusal(403, kOnlyLog);
    }
    if (name == "watch" && request.method == "POST") {
      return watch(request);
    }
    const auto found = actions.find(name);
    if (found == actions.end()) {
      return refusal(404, "there is no such command");
    }
    if (request.method != "POST") {
      return refusal(405, "commands are sent by POST");
    }
    const Command& command = found->second;
    if (const auto objection = rules->objection_to_origin(request.header("host"), request.header("origin"))) {
      return refusal(403, *objection);
    }
    if (const auto objection = rules->objection_to_token(request.header(kTokenHeader), command.role(request.body))) {
      return refusal(403, *objection);
    }
    if (command.only_json && !request.header("content-type").starts_with("application/json")) {
      return refusal(415, "the request must be application/json");
    }
    if (context.log == nullptr && name == "playback") {
      return refusal(404, kNoLog);
    }
    try {
      return text_answer(fmt::format(R"({{"id":{}}})", command.act(request.body)));
    } catch (const StaleVersion& error) {
      return refusal(409, error.what());
    } catch (const RequestError& error) {
      return refusal(400, error.what());
    } catch (const NotSent& error) {
      return refusal(503, error.what());
    }
  }

  // A page that is in view asks once a second, as it would send a STOP.
  HttpResponse watch(const HttpRequest& request) {
    if (const auto objection = rules->objection_to_origin(request.header("host"), request.header("origin"))) {
      return refusal(403, *objection);
    }
    try {
      context.desk.attend(context.clock.utime());
    } catch (const NotSent& error) {
      return refusal(503, error.what());
    }
    const bool may_command = !rules->objection_to_token(request.header(kTokenHeader), Role::kDrive);
    return text_answer(fmt::format(R"({{"may_command":{}}})", may_command));
  }

  [[nodiscard]] std::shared_ptr<const Building> building() const {
    // else one that nobody owns here
    return context.site != nullptr
               ? context.site->contents()
               : std::shared_ptr<const Building>(std::shared_ptr<const Building>(), &context.building);
  }

  // Browsers ask first before the page of one port sends JSON to another.
  static HttpResponse preflight() {
    HttpResponse response;
    response.status = 204;
    response.headers = {{"Access-Control-Allow-Methods", "POST"},
                        {"Access-Control-Allow-Headers", "Content-Type, X-Luminav-Token"},
                        {"Access-Control-Max-Age", "600"}};
    return response;
  }

  void allow_own_page(const HttpRequest& request, HttpResponse& response) const {
    const std::string origin(request.header("origin"));
    response.headers.emplace_back("Vary", "Origin");
    if (!origin.empty() && rules->is_own_page(request.header("host"), origin)) {
      response.headers.emplace_back("Access-Control-Allow-Origin", origin);
    }
  }

  HttpOptions options;
  Context context;
  Readings readings;                          // by path
  std::map<std::string, HttpResponse> files;  // by path
  std::map<std::string, std::string> names;   // of those that --web reads anew
  std::map<std::string, Command> actions;
  std::optional<AccessRules> rules;
  HttpListener commands;
  HttpListener page;
};

HttpServer::HttpServer(const HttpOptions& options, const Context& context)
    : servers_(std::make_unique<Servers>(options, context)) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const {
  return servers_->page.port();
}

int HttpServer::command_port() const {
  return servers_->commands.port();
}

std::vector<std::string> HttpServer::routes() const {
  std::vector<std::string> routes = {"POST /api/watch"};
  for (const auto& [path, reading] : servers_->readings) {
    routes.push_back("GET " + path);
  }
  for (const auto& [name, command] : servers_->actions) {
    routes.push_back(fmt::format("POST {}{}", kCommandPrefix, name));
  }
  std::sort(routes.begin(), routes.end());
  return routes;
}

std::string HttpServer::address() const {
  const HttpOptions& options = servers_->options;
  const bool is_everywhere = options.listen == "0.0.0.0" || options.listen == "::";
  std::string host = is_everywhere ? options.host_name : options.listen;
  if (host.find(':') != std::string::npos) {
    host = "[" + host + "]";
  }
  return fmt::format("http://{}:{}/", host, port());
}

}  // namespace luminav
