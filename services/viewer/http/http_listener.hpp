#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "services/viewer/http/http_connection.hpp"
#include "services/viewer/http/http_request.hpp"
#include "services/viewer/http/http_response.hpp"

namespace luminav {

struct HttpListenerParams {
  std::string listen = "127.0.0.1";  // address or name
  int port = 0;                      // 0 = any free one
  std::size_t connections = 400;
  std::size_t connections_per_address = 64;
  std::size_t endless = 40;                                       // answers without an end that are given at a time
  std::size_t endless_per_address = 10;                           // of these, to one machine other than this
  std::vector<std::pair<std::string, std::string>> headers = {};  // of each answer
};

/// Serves HTTP on one port, in one thread of its own that never waits for anybody: whoever sends or reads slowly keeps
/// a socket and some kilobytes, and loses them to whoever comes later when there are too many of them.
class HttpListener {
 public:
  /// Called from the listener's thread; must not wait either.
  using Answer = std::function<HttpResponse(const HttpRequest&)>;

  /// Binds the port; throws std::runtime_error when it is taken.
  explicit HttpListener(const HttpListenerParams& params);
  /// Ends the thread and all connections.
  ~HttpListener();
  HttpListener(const HttpListener&) = delete;
  HttpListener& operator=(const HttpListener&) = delete;

  /// Begins to serve.
  void start(Answer answer);
  [[nodiscard]] int port() const { return port_; }
  /// There may be more for these. May be called from any thread.
  void wake();

 private:
  void run();
  void wait();
  void accept_all(std::int64_t now);
  [[nodiscard]] bool make_room(const std::string& address);
  void answer_all(HttpConnection& connection, std::int64_t now);
  [[nodiscard]] HttpResponse answer(const HttpRequest& request) const;
  [[nodiscard]] bool may_be_endless(const std::string& address) const;

  HttpListenerParams params_;
  Answer answer_;
  int socket_ = -1;
  int port_ = 0;
  int wakeup_ = -1;
  std::atomic<bool> is_ending_{false};
  std::atomic<bool> has_news_{false};
  std::list<HttpConnection> connections_;  // oldest first
  std::thread thread_;
};

}  // namespace luminav
