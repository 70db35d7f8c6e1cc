#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace luminav {

/// What a client asks. Names of headers are in lower case.
struct HttpRequest {
  std::string method;
  std::string path;   // as it was sent: nothing here has a name that needs %xx
  std::string query;  // what follows "?"
  std::map<std::string, std::string, std::less<>> headers;
  std::string body;
  bool keeps_alive = true;  // the connection may serve another request

  /// "" when there is none.
  [[nodiscard]] std::string_view header(std::string_view name) const;
};

/// A request that is refused before it is read to its end. The connection cannot be used any more.
class HttpError : public std::runtime_error {
 public:
  HttpError(int status, const std::string& what) : std::runtime_error(what), status_(status) {}
  [[nodiscard]] int status() const { return status_; }

 private:
  int status_;
};

/// All of a request but its body.
struct HttpHead {
  HttpRequest request;
  std::size_t size = 0;          // [bytes] including the empty line
  std::size_t body_size = 0;     // [bytes] that follow
  bool awaits_go_ahead = false;  // Expect: 100-continue
};

inline constexpr std::size_t kLargestHead = 8 * 1024;   // [bytes]
inline constexpr std::size_t kLargestBody = 16 * 1024;  // [bytes] a route of a hundred stops has 8 kB

/// Reads the head at the beginning of `bytes`; nothing while its end has not come. Strict (RFC 9112): a body has one
/// Content-Length and is neither chunked nor compressed, so that its size is known before it is read. Throws HttpError.
std::optional<HttpHead> read_http_head(std::string_view bytes);

}  // namespace luminav
