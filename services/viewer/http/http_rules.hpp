#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace luminav {

/// A host and a port as a browser writes them in Host and Origin; port 80 when none is written.
struct HostAndPort {
  std::string host;  // lower case; IPv6 addresses without brackets
  int port = 80;
  friend bool operator==(const HostAndPort&, const HostAndPort&) = default;
};

/// Hosts and headers' names are the same in any case.
std::string to_lower(std::string_view text);
/// Reads "name", "name:port" and "[v6]:port"; nothing for anything else.
std::optional<HostAndPort> read_host(std::string_view text);
/// Reads the Origin of a page served over http; nothing for anything else ("null", https, a path).
std::optional<HostAndPort> read_origin(std::string_view text);

/// What somebody may do; each may what those before may.
enum class Role { kAnybody, kLook, kDrive, kAdminister };

/// "anybody", "look", ...
std::string_view name_of(Role role);

/// The secrets that tell who may what. Without `administer` everybody may do everything; without `drive` or `look`
/// nobody has that role, and without `look` everybody may look.
struct Tokens {
  std::string administer{};
  std::string drive{};
  std::string look{};
};

/// Value of one cookie in a Cookie header; "" when it is not there.
std::string_view read_cookie(std::string_view header, std::string_view name);

/// Who may ask. A page on a foreign site can make a visitor's browser send requests here, and a foreign name can be
/// made to resolve to this machine (DNS rebinding): so Host must be this machine, and Origin the page that it served.
class AccessRules {
 public:
  /// `listen` is the address bound; `own_name` this machine's host name.
  AccessRules(std::string listen, std::string own_name, int page_port, Tokens tokens);

  /// Why the request must be refused, or nothing. An absent Host is "".
  [[nodiscard]] std::optional<std::string> objection_to_host(std::string_view host) const;
  /// The same for what changes something. An absent Origin is "": it comes from no browser.
  [[nodiscard]] std::optional<std::string> objection_to_origin(std::string_view host, std::string_view origin) const;
  /// The same for what needs a role.
  [[nodiscard]] std::optional<std::string> objection_to_token(std::string_view token, Role needed) const;
  /// What somebody with this token may do.
  [[nodiscard]] Role role_of(std::string_view token) const;
  /// True for the page's own origin.
  [[nodiscard]] bool is_own_page(std::string_view host, std::string_view origin) const;

 private:
  std::string listen_;
  std::string own_name_;
  int page_port_;
  Tokens tokens_;
};

/// True for 127.x.y.z, ::1 and localhost.
bool is_loopback(std::string_view host);

}  // namespace luminav
