#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/viewer/http/http_request.hpp"
#include "services/viewer/http/http_response.hpp"

namespace luminav {

/// One client's connection: reads a request, then writes its answer, then reads the next. Never waits. What it holds is
/// bounded: a request of 24 kB and one answer. Times are steady [us].
class HttpConnection {
 public:
  using Headers = std::vector<std::pair<std::string, std::string>>;

  /// Takes over the socket, which must not block.
  HttpConnection(int socket, std::string address, std::int64_t now);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  /// Takes what has come.
  void receive(std::int64_t now);
  /// A request that is complete and not answered yet; it is gone from here then. Throws HttpError for what is none.
  [[nodiscard]] std::optional<HttpRequest> take_request();
  /// `headers` go into the head of the answer.
  void answer(const HttpRequest& request, HttpResponse response, const Headers& headers, std::int64_t now);
  /// The last answer: what the client sends from now on is thrown away.
  void refuse(const HttpError& error, const Headers& headers, std::int64_t now);
  /// Asks an answer that comes in pieces for more, if the client has taken all there was.
  void go_on(std::int64_t now);
  /// Gives the client what it takes.
  void send();
  /// Closes when the client was too slow.
  void check_time(std::int64_t now);
  void close();

  [[nodiscard]] int socket() const { return socket_; }  // -1 = closed
  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] bool is_endless() const { return static_cast<bool>(more_); }
  /// Its answer comes in pieces, as fast as the client takes them.
  [[nodiscard]] bool has_end() const { return left_ > 0; }
  [[nodiscard]] bool wants_to_send() const { return !output_.empty() || left_ > 0; }
  [[nodiscard]] bool wants_to_receive() const;
  /// Since when it keeps others waiting: since it came, or since its last answer.
  [[nodiscard]] std::int64_t since() const { return since_; }

 private:
  using Text = std::shared_ptr<const std::string>;
  void put_head(const HttpResponse& response, const Headers& headers, std::int64_t now);
  void put(Text text, std::int64_t now);
  void send_pieces(std::int64_t now);

  int socket_;
  std::string address_;
  std::int64_t since_;
  std::string input_;
  std::optional<HttpHead> head_;  // of a request whose body is still to come
  bool was_told_to_go_ahead_ = false;
  std::deque<Text> output_;
  std::size_t sent_ = 0;           // [bytes] of the first of these
  std::int64_t output_since_ = 0;  // when the oldest of it was ready
  bool closes_when_sent_ = false;
  bool is_over_ = false;         // nothing more is read, but thrown away
  std::size_t thrown_away_ = 0;  // [bytes]
  std::function<std::string()> more_;
  std::uint64_t left_ = 0;  // [bytes] to come of an answer in pieces that has an end
  std::string sign_of_life_;
  std::int64_t last_more_ = 0;
};

/// "Not Found" for 404.
const char* http_status_text(int status);

}  // namespace luminav
