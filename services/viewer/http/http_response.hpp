#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace luminav {

/// What a client is answered.
struct HttpResponse {
  int status = 200;
  std::string type = "application/json";
  std::shared_ptr<const std::string> body;  // null = empty
  std::vector<std::pair<std::string, std::string>> headers;
  /// Not null: the answer has no end. It is asked for more whenever there may be news and the client has taken all
  /// before; "" = nothing new.
  std::function<std::string()> more;
  /// Not 0: with `more`, the answer has an end all the same, after so many bytes. It comes as fast as the client takes
  /// it, and "" from `more` cuts it short.
  std::uint64_t size = 0;
  std::string sign_of_life;  // sent after a second without more
};

}  // namespace luminav
