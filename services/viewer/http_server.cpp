#include "services/viewer/http_server.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "services/viewer/http_rules.hpp"
#include "services/viewer/message_json.hpp"
#include "services/viewer/request_text.hpp"
#include "services/viewer/web_files.hpp"

namespace luminav {

std::string_view content_type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  return "application/octet-stream";
}

namespace {

constexpr int kMaxListeners = 40;  // each holds a thread of the page's server
constexpr std::size_t kPageThreads = 64;
constexpr std::size_t kCommandThreads = 16;
constexpr std::size_t kLargestRequest = 64 * 1024;  // [bytes]
constexpr std::size_t kTilesPerTick = 18 * 1024;    // [bytes] of map per client and tenth of a second
constexpr int kSendBuffer = 128 * 1024;             // [bytes] what a dead client can hold back

// httplib's default also sets SO_REUSEPORT: two viewers would share one port and each get half of the requests.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  const int size = kSendBuffer;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &size, sizeof(size));
}

void prepare(httplib::Server& server, std::size_t threads) {
  server.new_task_queue = [threads] { return new httplib::ThreadPool(threads); };
  server.set_socket_options(set_socket_options);
  server.set_payload_max_length(kLargestRequest);
  server.set_read_timeout(2);
  server.set_write_timeout(2);
  server.set_keep_alive_timeout(2);
  server.set_tcp_nodelay(true);
}

int bind_server(httplib::Server& server, const std::string& listen, int port) {
  const int bound = port == 0 ? server.bind_to_any_port(listen) : (server.bind_to_port(listen, port) ? port : -1);
  if (bound < 0) {
    throw std::runtime_error(
        fmt::format("cannot listen on {} port {}: another viewer has it, or this machine lacks the address; see --port",
                    listen, port));
  }
  return bound;
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(fmt::format(R"({{"error":{}}})", to_json(std::string_view(why))), "application/json");
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

}  // namespace

struct HttpServer::Servers {
  Servers(const HttpOptions& the_options, const Context& the_context) : options(the_options), context(the_context) {
    prepare(page, kPageThreads);
    prepare(commands, kCommandThreads);
    page_port = bind_server(page, options.listen, options.port);
    command_port = bind_server(commands, options.listen, options.command_port);
    rules = std::make_unique<AccessRules>(options.listen, options.host_name, page_port, options.token);
    guard(page);
    guard(commands);
    serve_files();
    serve_events();
    take_commands(page);
    take_commands(commands);
    start(page, page_thread);
    start(commands, command_thread);
  }

  ~Servers() {
    context.board.close();
    page.stop();
    commands.stop();
    page_thread.join();
    command_thread.join();
  }

  static void start(httplib::Server& server, std::thread& thread) {
    thread = std::thread([&server] { server.listen_after_bind(); });
    while (!server.is_running()) {  // stop() before that would be lost
      std::this_thread::yield();
    }
  }

  // Every answer: no guessing of types, nothing from elsewhere, never inside a foreign page, where a click could be
  // stolen.
  void guard(httplib::Server& server) {
    server.set_default_headers(
        {{"X-Content-Type-Options", "nosniff"},
         {"X-Frame-Options", "DENY"},
         {"Referrer-Policy", "no-referrer"},
         {"Cache-Control", "no-store"},
         {"Content-Security-Policy",
          fmt::format("default-src 'self'; img-src 'self' data: blob:; connect-src 'self' *:{}; frame-ancestors 'none'",
                      command_port)}});
    server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      if (const auto objection = rules->objection_to_host(request.get_header_value("Host"))) {
        refuse(response, 403, *objection);
        return httplib::Server::HandlerResponse::Handled;
      }
      return httplib::Server::HandlerResponse::Unhandled;
    });
  }

  void serve_files() {
    for (const WebFile& file : web_files()) {
      const std::string pattern = file.name == "index.html" ? "/" : fmt::format("/{}", file.name);
      page.Get(escape(pattern), [this, file](const httplib::Request&, httplib::Response& response) {
        const std::string type(content_type_of(file.name));
        if (options.web_folder.empty()) {
          response.set_content(file.content.data(), file.content.size(), type);
        } else {  // names from the built-in list only: no path gets out of the folder
          response.set_content(read_file(fmt::format("{}/{}", options.web_folder, file.name)), type);
        }
      });
    }
    const std::string building = to_json(context.building, context.robot);
    page.Get("/building\\.json", [building](const httplib::Request&, httplib::Response& response) {
      response.set_content(building, "application/json");
    });
    page.Get("/settings\\.json", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(
          fmt::format(R"({{"command_port":{},"needs_token":{}}})", command_port, !options.token.empty()),
          "application/json");
    });
    // With ?sequence=N that very one: what was found in it is drawn over it.
    page.Get("/camera\\.jpg", [this](const httplib::Request& request, httplib::Response& response) {
      const bool is_meant = request.has_param("sequence");
      const PictureStore::Jpeg jpeg =
          is_meant ? find_picture(request.get_param_value("sequence")) : context.pictures.newest();
      if (jpeg) {
        response.set_content(*jpeg, "image/jpeg");
      } else {
        refuse(response, 404, is_meant ? "this camera picture is not there, or not any more" : "no camera picture yet");
      }
    });
  }

  [[nodiscard]] PictureStore::Jpeg find_picture(const std::string& sequence) const {
    std::int32_t number = 0;
    const auto [end, error] = std::from_chars(sequence.data(), sequence.data() + sequence.size(), number);
    const bool is_number = error == std::errc() && end == sequence.data() + sequence.size();
    return is_number ? context.pictures.find(number) : nullptr;
  }

  // httplib takes paths as regular expressions.
  static std::string escape(const std::string& path) {
    std::string pattern;
    for (const char letter : path) {
      pattern += letter == '.' ? std::string("\\.") : std::string(1, letter);
    }
    return pattern;
  }

  void serve_events() {
    page.Get("/events", [this](const httplib::Request& request, httplib::Response& response) {
      if (request.method != "GET") {
        return;
      }
      if (listeners.fetch_add(1) >= kMaxListeners) {
        --listeners;
        response.set_header("Retry-After", "2");
        refuse(response, 503, fmt::format("{} pages are open already", kMaxListeners));
        return;
      }
      const auto cursor = std::make_shared<SnapshotBoard::Cursor>();
      response.set_chunked_content_provider(
          "text/event-stream",
          [this, cursor](std::size_t, httplib::DataSink& sink) { return send_news(*cursor, sink); },
          [this](bool) { --listeners; });
    });
  }

  // A write that takes longer than two seconds fails and ends the connection; the page connects again.
  bool send_news(SnapshotBoard::Cursor& cursor, httplib::DataSink& sink) {
    std::string batch = cursor.tick == 0 ? "retry: 1000\n\n" : "";
    for (const SnapshotBoard::Text& text : context.board.read(cursor, 1000, kTilesPerTick)) {
      batch += *text;
    }
    if (context.board.is_closed()) {
      return false;
    }
    if (batch.empty()) {
      batch = ": nothing new\n\n";
    }
    return sink.write(batch.data(), batch.size());
  }

  void take_commands(httplib::Server& server) {
    on_command(server, "/api/goal", true, [this](const std::string& body) {
      return context.desk.send(read_goal_request(body, context.building), context.clock.utime());
    });
    // taken in any dress: a stop must not fail for a header
    on_command(server, "/api/stop", false, [this](const std::string& body) {
      return context.desk.send(read_stop_request(body), context.clock.utime());
    });
    on_command(server, "/api/motors", true, [this](const std::string& body) {
      return context.desk.send(read_motors_request(body), context.clock.utime());
    });
    on_command(server, "/api/initial_pose", true, [this](const std::string& body) {
      return context.desk.send(read_initial_pose_request(body), context.clock.utime());
    });
    on_command(server, "/api/map", true, [this](const std::string& body) {
      return context.desk.send(read_map_request(body), context.clock.utime());
    });
    on_command(server, "/api/process", true, [this](const std::string& body) {
      return context.processes.order(read_process_order(body), context.clock.utime());
    });
    on_command(server, "/api/steering", true, [this](const std::string& body) {
      const Steering steering = read_steering(body);
      context.helm.steer(steering, context.clock.utime());
      return static_cast<std::int64_t>(steering.sequence);
    });
    // browsers ask first before the page of one port sends JSON to another
    server.Options("/api/.*", [this](const httplib::Request& request, httplib::Response& response) {
      allow_own_page(request, response);
      response.set_header("Access-Control-Allow-Methods", "POST");
      response.set_header("Access-Control-Allow-Headers", "Content-Type, X-Luminav-Token");
      response.set_header("Access-Control-Max-Age", "600");
      response.status = 204;
    });
  }

  void allow_own_page(const httplib::Request& request, httplib::Response& response) const {
    const std::string origin = request.get_header_value("Origin");
    response.set_header("Vary", "Origin");
    if (!origin.empty() && rules->is_own_page(request.get_header_value("Host"), origin)) {
      response.set_header("Access-Control-Allow-Origin", origin);
    }
  }

  void on_command(httplib::Server& server, const char* path, bool only_json,
                  std::function<std::int64_t(const std::string&)> act) {
    server.Post(
        path, [this, only_json, act = std::move(act)](const httplib::Request& request, httplib::Response& response) {
          allow_own_page(request, response);
          if (const auto objection =
                  rules->objection_to_command(request.get_header_value("Host"), request.get_header_value("Origin"),
                                              request.get_header_value("X-Luminav-Token"))) {
            refuse(response, 403, *objection);
            return;
          }
          if (only_json && !request.get_header_value("Content-Type").starts_with("application/json")) {
            refuse(response, 415, "the request must be application/json");
            return;
          }
          try {
            response.set_content(fmt::format(R"({{"id":{}}})", act(request.body)), "application/json");
          } catch (const RequestError& error) {
            refuse(response, 400, error.what());
          } catch (const NotSent& error) {
            refuse(response, 503, error.what());
          }
        });
  }

  HttpOptions options;
  Context context;
  std::unique_ptr<AccessRules> rules;
  httplib::Server page;
  httplib::Server commands;
  int page_port = 0;
  int command_port = 0;
  std::atomic<int> listeners{0};
  std::thread page_thread;
  std::thread command_thread;
};

HttpServer::HttpServer(const HttpOptions& options, const Context& context)
    : servers_(std::make_unique<Servers>(options, context)) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const {
  return servers_->page_port;
}

int HttpServer::command_port() const {
  return servers_->command_port;
}

int HttpServer::listeners() const {
  return servers_->listeners;
}

std::string HttpServer::address() const {
  const HttpOptions& options = servers_->options;
  const bool is_everywhere = options.listen == "0.0.0.0" || options.listen == "::";
  std::string host = is_everywhere ? options.host_name : options.listen;
  if (host.find(':') != std::string::npos) {
    host = "[" + host + "]";
  }
  // after the hash: browsers keep it to themselves, so it gets into no log
  return fmt::format("http://{}:{}/{}", host, port(), options.token.empty() ? "" : "#token=" + options.token);
}

}  // namespace luminav
