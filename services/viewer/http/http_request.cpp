#include "services/viewer/http/http_request.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "services/viewer/http/http_rules.hpp"

namespace luminav {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

// Of methods and of headers' names.
bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 ||
           std::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(letter)) != std::string_view::npos;
  });
}

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char letter) { return letter >= 0x20 && letter != 0x7f; });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

void read_request_line(std::string_view line, HttpRequest& request) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last || !is_printable(line)) {
    throw HttpError(400, "the request line is not METHOD PATH VERSION");
  }
  const std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (!is_token(line.substr(0, first)) || target.empty() || target.front() != '/' ||
      target.find(' ') != std::string_view::npos) {
    throw HttpError(400, "the request line is not METHOD PATH VERSION");
  }
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    throw HttpError(505, "only HTTP/1.1 is spoken here");
  }
  request.method = line.substr(0, first);
  const std::size_t question = std::min(target.find('?'), target.size());
  request.path = target.substr(0, question);
  request.query = target.substr(std::min(question + 1, target.size()));
  request.keeps_alive = version == "HTTP/1.1";
}

void read_header(std::string_view line, HttpRequest& request) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) {
    throw HttpError(400, "a header is not NAME: VALUE");
  }
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (std::find_if(value.begin(), value.end(), [](unsigned char letter) {
        return (letter < 0x20 && letter != '\t') || letter == 0x7f;
      }) != value.end()) {
    throw HttpError(400, "a header has letters that are none");
  }
  const auto [entry, is_new] = request.headers.emplace(to_lower(line.substr(0, colon)), value);
  if (!is_new) {
    const bool must_be_one = entry->first == "host" || entry->first == "content-length" || entry->first == "origin" ||
                             entry->first == "x-luminav-token";
    if (must_be_one) {
      throw HttpError(400, entry->first + " comes twice");
    }
    entry->second.append(", ").append(value);
  }
}

std::size_t read_body_size(const HttpRequest& request) {
  if (!request.header("transfer-encoding").empty() || !request.header("content-encoding").empty()) {
    throw HttpError(415, "a body must be plain and have a Content-Length");
  }
  const auto found = request.headers.find("content-length");
  if (found == request.headers.end()) {
    return 0;
  }
  const std::string& text = found->second;
  std::size_t size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (error == std::errc::invalid_argument || end != text.data() + text.size() || text.front() == '-') {
    throw HttpError(400, "Content-Length is no number");
  }
  if (error != std::errc() || size > kLargestBody) {
    throw HttpError(413, "the body is too large");
  }
  return size;
}

}  // namespace

std::string_view HttpRequest::header(std::string_view name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? std::string_view() : std::string_view(found->second);
}

std::optional<HttpHead> read_http_head(std::string_view bytes) {
  const std::size_t end = bytes.substr(0, kLargestHead).find("\r\n\r\n");
  if (end == std::string_view::npos) {
    if (bytes.size() >= kLargestHead) {
      throw HttpError(431, "the head of the request is too long");
    }
    return std::nullopt;
  }
  HttpHead head;
  head.size = end + 2 * kLineEnd.size();
  std::string_view rest = bytes.substr(0, end + kLineEnd.size());
  bool is_first = true;
  while (!rest.empty()) {
    const std::size_t line_end = rest.find(kLineEnd);
    const std::string_view line = rest.substr(0, line_end);
    rest.remove_prefix(line_end + kLineEnd.size());
    if (is_first) {
      read_request_line(line, head.request);
      is_first = false;
    } else {
      read_header(line, head.request);
    }
  }
  head.body_size = read_body_size(head.request);
  const std::string connection = to_lower(head.request.header("connection"));
  if (connection.find("close") != std::string::npos) {
    head.request.keeps_alive = false;
  }
  head.awaits_go_ahead = to_lower(head.request.header("expect")) == "100-continue";
  return head;
}

}  // namespace luminav
