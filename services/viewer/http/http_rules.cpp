#include "services/viewer/http/http_rules.hpp"

#include <arpa/inet.h>
#include <openssl/crypto.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace luminav {
namespace {

bool is_address(const std::string& host) {
  in6_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1 || inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

bool is_name(const std::string& host) {
  return !host.empty() && host.size() <= 253 && std::all_of(host.begin(), host.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '-' || letter == '.' || letter == '_';
  });
}

// Takes as long for a wrong first letter as for a wrong last one. A secret that does not exist is nobody's.
bool is_same_secret(std::string_view expected, std::string_view given) {
  return !expected.empty() && expected.size() == given.size() &&
         CRYPTO_memcmp(expected.data(), given.data(), expected.size()) == 0;
}

}  // namespace

std::string to_lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

std::optional<HostAndPort> read_host(std::string_view text) {
  HostAndPort result;
  std::string_view rest;
  if (!text.empty() && text.front() == '[') {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) {
      return std::nullopt;
    }
    result.host = to_lower(text.substr(1, end - 1));
    rest = text.substr(end + 1);
    if (!is_address(result.host)) {
      return std::nullopt;
    }
  } else {
    const std::size_t colon = std::min(text.find(':'), text.size());
    result.host = to_lower(text.substr(0, colon));
    rest = text.substr(colon);
    if (!is_name(result.host)) {
      return std::nullopt;
    }
  }
  if (rest.empty()) {
    return result;
  }
  const char* end = rest.data() + rest.size();
  const auto [stop, error] = std::from_chars(rest.data() + 1, end, result.port);
  if (rest.front() != ':' || error != std::errc{} || stop != end || result.port < 1 || result.port > 65535) {
    return std::nullopt;
  }
  return result;
}

std::optional<HostAndPort> read_origin(std::string_view text) {
  constexpr std::string_view kScheme = "http://";
  if (!text.starts_with(kScheme)) {
    return std::nullopt;
  }
  return read_host(text.substr(kScheme.size()));
}

std::string_view name_of(Role role) {
  switch (role) {
    case Role::kAnybody:
      return "anybody";
    case Role::kLook:
      return "look";
    case Role::kDrive:
      return "drive";
    case Role::kAdminister:
      return "administer";
  }
  return "";
}

bool is_loopback(std::string_view host) {
  const std::string text(host);
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) == 1) {
    return (ntohl(address.s_addr) >> 24) == 127;
  }
  return text == "::1" || text == "localhost";
}

std::string_view read_cookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(';'), header.size());
    std::string_view pair = header.substr(0, end);
    header.remove_prefix(std::min(end + 1, header.size()));
    pair.remove_prefix(std::min(pair.find_first_not_of(' '), pair.size()));
    if (pair.size() > name.size() && pair.starts_with(name) && pair[name.size()] == '=') {
      return pair.substr(name.size() + 1);
    }
  }
  return {};
}

AccessRules::AccessRules(std::string listen, std::string own_name, int page_port, Tokens tokens)
    : listen_(to_lower(listen)), own_name_(to_lower(own_name)), page_port_(page_port), tokens_(std::move(tokens)) {}

std::optional<std::string> AccessRules::objection_to_host(std::string_view host) const {
  const auto asked = read_host(host);
  if (!asked) {
    return "the request names no host";
  }
  const bool is_known = is_loopback(asked->host) || asked->host == listen_ ||
                        (!is_loopback(listen_) &&
                         (is_address(asked->host) || asked->host == own_name_ || asked->host == own_name_ + ".local"));
  if (is_known) {
    return std::nullopt;
  }
  return "this machine is not called " + asked->host;
}

bool AccessRules::is_own_page(std::string_view host, std::string_view origin) const {
  const auto asked = read_host(host);
  const auto page = read_origin(origin);
  // a forwarded port may differ from ours: then page and command have the same one
  return asked && page && asked->host == page->host && (page->port == page_port_ || page->port == asked->port);
}

std::optional<std::string> AccessRules::objection_to_origin(std::string_view host, std::string_view origin) const {
  if (!origin.empty() && !is_own_page(host, origin)) {
    return "commands are taken from the viewer's own page only";
  }
  return std::nullopt;
}

Role AccessRules::role_of(std::string_view token) const {
  if (tokens_.administer.empty() || is_same_secret(tokens_.administer, token)) {
    return Role::kAdminister;
  }
  if (is_same_secret(tokens_.drive, token)) {
    return Role::kDrive;
  }
  return tokens_.look.empty() || is_same_secret(tokens_.look, token) ? Role::kLook : Role::kAnybody;
}

std::optional<std::string> AccessRules::objection_to_token(std::string_view token, Role needed) const {
  const Role role = role_of(token);
  if (role >= needed) {
    return std::nullopt;
  }
  if (role == Role::kDrive) {
    return "this token may look and drive: here one is needed that may administer";
  }
  if (is_same_secret(tokens_.look, token)) {
    return "this token may look only: here one is needed that may do more";
  }
  return "the token is missing or wrong: open the page by the address that holds it, see scripts/view --help";
}

}  // namespace luminav
