#include "services/viewer/http/http_connection.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace luminav {
namespace {

constexpr std::int64_t kRequestTime = 3'000'000;  // [us] for a whole request, from its first byte or from connecting
constexpr std::int64_t kIdleTime = 10'000'000;    // [us] between requests
constexpr std::int64_t kAnswerTime = 20'000'000;  // [us] for a whole answer: a large map over a poor radio link
constexpr std::int64_t kNewsTime = 3'000'000;     // [us] for a piece of an answer without an end
constexpr std::int64_t kFarewell = 1'000'000;     // [us] in which a client may hear why it was refused
constexpr std::size_t kLargestRest = 64 * 1024;   // [bytes] of what a client sends unasked
constexpr int kPiecesAtOnce = 8;
constexpr std::int64_t kSignOfLife = 1'000'000;  // [us]

std::string json_error(const std::string& why) {
  std::string quoted;  // of our own words only
  for (const char letter : why) {
    quoted += letter == '"' || letter == '\\' ? ' ' : letter;
  }
  return fmt::format(R"({{"error":"{}"}})", quoted);
}

}  // namespace

const char* http_status_text(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 413:
      return "Content Too Large";
    case 415:
      return "Unsupported Media Type";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Internal Server Error";
  }
}

HttpConnection::HttpConnection(int socket, std::string address, std::int64_t now)
    : socket_(socket), address_(std::move(address)), since_(now) {}

HttpConnection::~HttpConnection() {
  close();
}

void HttpConnection::close() {
  if (socket_ >= 0) {
    ::close(socket_);
    socket_ = -1;
  }
  more_ = nullptr;
  left_ = 0;
}

bool HttpConnection::wants_to_receive() const {
  return is_over_ || is_endless() || input_.size() < kLargestHead + kLargestBody;
}

void HttpConnection::receive(std::int64_t now) {
  std::array<char, 8192> bytes;
  const ssize_t count = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) {
    close();
    return;
  }
  if (count < 0) {
    return;
  }
  if (is_over_ || is_endless()) {  // nothing is asked for any more
    thrown_away_ += static_cast<std::size_t>(count);
    if (thrown_away_ > kLargestRest) {
      close();
    }
    return;
  }
  if (input_.empty() && output_.empty()) {
    since_ = now;
  }
  input_.append(bytes.data(), static_cast<std::size_t>(count));
}

std::optional<HttpRequest> HttpConnection::take_request() {
  if (socket_ < 0 || is_over_ || is_endless() || closes_when_sent_ || !output_.empty()) {
    return std::nullopt;
  }
  if (!head_) {
    head_ = read_http_head(input_);
    if (!head_) {
      return std::nullopt;
    }
    input_.erase(0, head_->size);
  }
  if (input_.size() < head_->body_size) {
    if (head_->awaits_go_ahead && !was_told_to_go_ahead_) {
      was_told_to_go_ahead_ = true;
      put(std::make_shared<const std::string>("HTTP/1.1 100 Continue\r\n\r\n"), since_);
      send();
    }
    return std::nullopt;
  }
  HttpRequest request = std::move(head_->request);
  request.body = input_.substr(0, head_->body_size);
  input_.erase(0, head_->body_size);
  head_.reset();
  was_told_to_go_ahead_ = false;
  return request;
}

void HttpConnection::put(Text text, std::int64_t now) {
  if (output_.empty()) {
    output_since_ = now;
  }
  output_.push_back(std::move(text));
}

void HttpConnection::put_head(const HttpResponse& response, const Headers& headers, std::int64_t now) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n", response.status, http_status_text(response.status));
  const auto add = [&](std::string_view name, std::string_view value) {
    head += fmt::format("{}: {}\r\n", name, value);
  };
  for (const Headers* list : {&headers, &response.headers}) {
    for (const auto& [name, value] : *list) {
      add(name, value);
    }
  }
  if (response.body || response.more) {
    add("Content-Type", response.type);
  }
  if (response.more && response.size > 0) {
    add("Content-Length", std::to_string(response.size));
  } else if (!response.more && response.status != 204) {
    add("Content-Length", std::to_string(response.body ? response.body->size() : 0));
  }
  add("Connection", closes_when_sent_ || response.more ? "close" : "keep-alive");
  put(std::make_shared<const std::string>(head + "\r\n"), now);
}

void HttpConnection::answer(const HttpRequest& request, HttpResponse response, const Headers& headers,
                            std::int64_t now) {
  closes_when_sent_ = !request.keeps_alive;
  put_head(response, headers, now);
  if (request.method == "HEAD") {
    closes_when_sent_ = closes_when_sent_ || response.more;
  } else if (response.more) {
    closes_when_sent_ = false;  // what has no end is never all sent, also for who wants no second answer
    more_ = std::move(response.more);
    left_ = response.size;
    sign_of_life_ = std::move(response.sign_of_life);
    last_more_ = now;
    input_.clear();
  } else if (response.body && !response.body->empty()) {
    put(std::move(response.body), now);
  }
  since_ = now;
  send();
}

void HttpConnection::refuse(const HttpError& error, const Headers& headers, std::int64_t now) {
  HttpResponse response;
  response.status = error.status();
  response.body = std::make_shared<const std::string>(json_error(error.what()));
  closes_when_sent_ = true;
  put_head(response, headers, now);
  put(response.body, now);
  input_.clear();
  input_.shrink_to_fit();
  since_ = now;
  send();
}

void HttpConnection::go_on(std::int64_t now) {
  if (!more_ || !output_.empty() || socket_ < 0) {
    return;
  }
  if (left_ > 0) {
    send_pieces(now);
    return;
  }
  std::string text = more_();
  if (text.empty() && now - last_more_ > kSignOfLife) {
    text = sign_of_life_;
  }
  if (!text.empty()) {
    last_more_ = now;
    put(std::make_shared<const std::string>(std::move(text)), now);
    send();
  }
}

// A few at a time: others wait too.
void HttpConnection::send_pieces(std::int64_t now) {
  for (int i = 0; i < kPiecesAtOnce && left_ > 0 && output_.empty(); ++i) {
    std::string piece = more_();
    if (piece.empty() || piece.size() > left_) {  // the client sees that something is missing
      close();
      return;
    }
    left_ -= piece.size();
    if (left_ == 0) {
      more_ = nullptr;
      closes_when_sent_ = true;
    }
    put(std::make_shared<const std::string>(std::move(piece)), now);
    send();
  }
}

void HttpConnection::send() {
  while (socket_ >= 0 && !output_.empty()) {
    const std::string& text = *output_.front();
    const ssize_t count = ::send(socket_, text.data() + sent_, text.size() - sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count < 0) {
      if (errno != EAGAIN && errno != EINTR) {
        close();
      }
      return;
    }
    sent_ += static_cast<std::size_t>(count);
    if (sent_ == text.size()) {
      output_.pop_front();
      sent_ = 0;
    }
  }
  if (socket_ >= 0 && closes_when_sent_ && !is_over_) {
    // Closing now, with bytes of the client unread, would take the answer away from it again.
    shutdown(socket_, SHUT_WR);
    is_over_ = true;
  }
}

void HttpConnection::check_time(std::int64_t now) {
  if (socket_ < 0) {
    return;
  }
  const bool waits_for_client = !output_.empty();
  const std::int64_t since = waits_for_client && !is_over_ ? output_since_ : since_;
  std::int64_t patience = kIdleTime;
  if (is_over_) {
    patience = kFarewell;
  } else if (waits_for_client) {
    patience = more_ ? kNewsTime : kAnswerTime;
  } else if (more_) {
    return;
  } else if (head_ || !input_.empty()) {
    patience = kRequestTime;
  }
  if (now - since > patience) {
    close();
  }
}

}  // namespace luminav
