#include "tests/replay/tool/bridge/foxglove_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "services/viewer/http/http_rules.hpp"

namespace luminav {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Json = nlohmann::json;
using boost::system::error_code;
using tcp = asio::ip::tcp;

constexpr std::size_t kMaxClients = 20;
constexpr std::size_t kMaxWaiting = 2'000'000;       // [bytes] for one client; a picture has 50 kB
constexpr std::size_t kMaxDescriptions = 8'000'000;  // [bytes] of channels and statuses, which are not left out
constexpr std::size_t kLongestRequest = 64 * 1024;   // [bytes]
constexpr unsigned kLongestHead = 8 * 1024;          // [bytes]
constexpr std::chrono::seconds kPatience(5);         // for a request's head
constexpr int kWarning = 1;

struct Frame {
  std::shared_ptr<const std::string> bytes;
  bool is_text = false;
};

template <typename Number>
void append(std::string& bytes, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    bytes += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
  }
}

std::string view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// The one of ours that the client names first; "" when it names none.
std::string chosen_protocol(const http::request<http::empty_body>& request) {
  for (const beast::string_view name : http::token_list(request[http::field::sec_websocket_protocol])) {
    if (name == "foxglove.websocket.v1" || name == "foxglove.sdk.v1") {
      return view(name);
    }
  }
  return "";
}

}  // namespace

struct FoxgloveServer::Hub {
  struct Description {
    std::string topic, schema_name, schema;
    bool is_kept = false;
  };
  struct Message {
    std::uint64_t log_time = 0;  // [ns]
    std::string json;
  };

  explicit Hub(const FoxgloveServerOptions& the_options);
  void accept();
  [[nodiscard]] std::optional<std::string> objection_to(const http::request<http::empty_body>& request) const;
  [[nodiscard]] Json advertisement(Channel channel) const;

  FoxgloveServerOptions options;
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  std::optional<AccessRules> rules;
  std::vector<Description> channels;
  std::map<Channel, Message> kept;
  std::set<std::shared_ptr<Session>> sessions;
  std::int64_t lost = 0;
};

/// One client, from its handshake to its end.
class FoxgloveServer::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(tcp::socket socket, Hub& hub) : hub_(hub), stream_(std::move(socket)) {}

  void start() {
    head_.header_limit(kLongestHead);
    beast::get_lowest_layer(stream_).expires_after(kPatience);
    http::async_read_header(
        stream_.next_layer(), buffer_, head_,
        [self = shared_from_this()](error_code error, std::size_t) { error ? self->end() : self->answer(); });
  }

  /// Tells of channels, or of anything else that may not be left out.
  void tell(const Json& json) {
    auto text = std::make_shared<const std::string>(json.dump(-1, ' ', false, Json::error_handler_t::replace));
    if (waiting_ + text->size() > kMaxDescriptions) {
      end();
      return;
    }
    push({std::move(text), true});
  }

  void send(Channel channel, const Hub::Message& message) {
    const auto subscription = subscriptions_.find(channel);
    if (!is_open_ || subscription == subscriptions_.end()) {
      return;
    }
    if (waiting_ + message.json.size() > kMaxWaiting) {
      ++hub_.lost;
      is_told_ =
          is_told_ ||
          (tell({{"op", "status"}, {"level", kWarning}, {"message", "this client is too slow: messages are left out"}}),
           true);
      return;
    }
    std::string bytes(1, '\x01');  // Message Data
    append(bytes, subscription->second);
    append(bytes, message.log_time);
    bytes += message.json;
    push({std::make_shared<const std::string>(std::move(bytes)), false});
  }

  [[nodiscard]] bool is_open() const { return is_open_; }

  void end() {
    is_open_ = false;
    error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
    hub_.sessions.erase(shared_from_this());
  }

 private:
  void answer() {
    const http::request<http::empty_body>& request = head_.get();
    const std::string protocol = chosen_protocol(request);
    std::optional<std::string> objection = hub_.objection_to(request);
    if (objection || protocol.empty() || !websocket::is_upgrade(request)) {
      refuse(objection ? http::status::forbidden : http::status::bad_request,
             objection.value_or("only WebSocket with the subprotocol foxglove.websocket.v1 or foxglove.sdk.v1"));
      return;
    }
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, protocol);
    }));
    stream_.read_message_max(kLongestRequest);
    stream_.async_accept(request,
                         [self = shared_from_this()](error_code error) { error ? self->end() : self->greet(); });
  }

  void refuse(http::status status, const std::string& why) {
    auto response = std::make_shared<http::response<http::string_body>>(status, 11);
    response->set(http::field::content_type, "application/json");
    response->keep_alive(false);
    response->body() = Json({{"error", why}}).dump() + "\n";
    response->prepare_payload();
    http::async_write(stream_.next_layer(), *response,
                      [self = shared_from_this(), response](error_code, std::size_t) { self->end(); });
  }

  void greet() {
    is_open_ = true;
    tell({{"op", "serverInfo"}, {"name", "luminav"}, {"capabilities", Json::array()}, {"metadata", Json::object()}});
    Json channels = Json::array();
    for (std::size_t i = 0; i < hub_.channels.size(); ++i) {
      channels.push_back(hub_.advertisement(static_cast<Channel>(i + 1)));
    }
    tell({{"op", "advertise"}, {"channels", channels}});
    read();
  }

  void read() {
    buffer_.clear();
    stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) {
        self->end();
        return;
      }
      self->obey(beast::buffers_to_string(self->buffer_.data()));
      if (self->is_open_) {
        self->read();
      }
    });
  }

  void obey(const std::string& text) {
    try {
      const Json request = Json::parse(text);
      if (request.at("op") == "subscribe") {
        for (const Json& wish : request.at("subscriptions")) {
          subscribe(wish.at("channelId").get<std::uint32_t>(), wish.at("id").get<std::uint32_t>());
        }
      } else if (request.at("op") == "unsubscribe") {
        for (const Json& id : request.at("subscriptionIds")) {
          std::erase_if(subscriptions_, [&](const auto& pair) { return pair.second == id.get<std::uint32_t>(); });
        }
      } else {
        complain("only subscribe and unsubscribe are understood");
      }
    } catch (const Json::exception&) {
      complain("a request must be JSON as Foxglove's protocol has it");
    }
  }

  void subscribe(std::uint32_t channel, std::uint32_t id) {
    if (channel < 1 || channel > hub_.channels.size()) {
      complain(fmt::format("there is no channel {}", channel));
      return;
    }
    subscriptions_[static_cast<Channel>(channel)] = id;
    const auto kept = hub_.kept.find(static_cast<Channel>(channel));
    if (kept != hub_.kept.end()) {
      send(kept->first, kept->second);
    }
  }

  void complain(const std::string& why) { tell({{"op", "status"}, {"level", kWarning}, {"message", why}}); }

  void push(Frame frame) {
    waiting_ += frame.bytes->size();
    frames_.push_back(std::move(frame));
    if (frames_.size() == 1) {
      write();
    }
  }

  void write() {
    stream_.text(frames_.front().is_text);
    stream_.async_write(asio::buffer(*frames_.front().bytes),
                        [self = shared_from_this()](error_code error, std::size_t) {
                          if (error) {
                            self->end();
                            return;
                          }
                          self->waiting_ -= self->frames_.front().bytes->size();
                          self->frames_.pop_front();
                          if (self->frames_.empty()) {
                            self->is_told_ = false;
                          } else {
                            self->write();
                          }
                        });
  }

  Hub& hub_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_{kLongestRequest + kLongestHead};
  http::request_parser<http::empty_body> head_;
  std::map<Channel, std::uint32_t> subscriptions_;  // the client's own number of each
  std::deque<Frame> frames_;                        // the first is on its way
  std::size_t waiting_ = 0;                         // [bytes] in them
  bool is_open_ = false;
  bool is_told_ = false;  // that it is slow
};

FoxgloveServer::Hub::Hub(const FoxgloveServerOptions& the_options) : options(the_options) {
  error_code error;
  const tcp::endpoint endpoint(asio::ip::make_address(options.listen, error), static_cast<std::uint16_t>(options.port));
  if (error) {
    throw std::runtime_error(fmt::format("--listen {}: must be an address of this machine", options.listen));
  }
  acceptor.open(endpoint.protocol());
  acceptor.set_option(asio::socket_base::reuse_address(true));
  acceptor.bind(endpoint, error);
  if (error) {
    throw std::runtime_error(
        fmt::format("port {} of {} cannot be had: {}", options.port, options.listen, error.message()));
  }
  acceptor.listen();
  rules.emplace(options.listen, options.host_name, acceptor.local_endpoint().port(), Tokens{});
  accept();
}

void FoxgloveServer::Hub::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) {
      return;
    }
    if (!error && sessions.size() < kMaxClients) {
      auto session = std::make_shared<Session>(std::move(socket), *this);
      sessions.insert(session);
      session->start();
    }
    accept();
  });
}

std::optional<std::string> FoxgloveServer::Hub::objection_to(const http::request<http::empty_body>& request) const {
  const std::string host = view(request[http::field::host]);
  const std::string origin = view(request[http::field::origin]);
  if (auto objection = rules->objection_to_host(host)) {
    return objection;
  }
  const auto page = read_origin(origin);
  const bool is_ours = origin.empty() || origin == "file://" ||  // no browser, or a program made of one
                       std::find(options.origins.begin(), options.origins.end(), origin) != options.origins.end() ||
                       (page && (is_loopback(page->host) || page->host == read_host(host)->host));
  return is_ours ? std::nullopt : std::optional(fmt::format("pages of {} may listen only with --origin", origin));
}

Json FoxgloveServer::Hub::advertisement(Channel channel) const {
  const Description& description = channels[channel - 1U];
  return {{"id", channel},
          {"topic", description.topic},
          {"encoding", "json"},
          {"schemaName", description.schema_name},
          {"schema", description.schema},
          {"schemaEncoding", "jsonschema"}};
}

FoxgloveServer::FoxgloveServer(const FoxgloveServerOptions& options) : hub_(std::make_unique<Hub>(options)) {}

FoxgloveServer::~FoxgloveServer() {
  while (!hub_->sessions.empty()) {
    (*hub_->sessions.begin())->end();
  }
  error_code ignored;
  hub_->acceptor.close(ignored);
  poll();
}

MessageSink::Channel FoxgloveServer::add_channel(const std::string& topic, const std::string& schema_name,
                                                 const std::string& schema) {
  const std::vector<std::string>& kept = hub_->options.kept_topics;
  hub_->channels.push_back({topic, schema_name, schema, std::find(kept.begin(), kept.end(), topic) != kept.end()});
  const auto channel = static_cast<Channel>(hub_->channels.size());
  const Json news = {{"op", "advertise"}, {"channels", {hub_->advertisement(channel)}}};
  for (const auto& session : std::set(hub_->sessions)) {  // one may end meanwhile
    if (session->is_open()) {
      session->tell(news);
    }
  }
  return channel;
}

void FoxgloveServer::write(Channel channel, std::uint64_t log_time, std::uint64_t, std::string_view json) {
  const bool is_kept = hub_->channels[channel - 1U].is_kept;
  if (hub_->sessions.empty() && !is_kept) {
    return;
  }
  const Hub::Message message{log_time, std::string(json)};
  for (const auto& session : std::set(hub_->sessions)) {
    session->send(channel, message);
  }
  if (is_kept) {
    hub_->kept[channel] = message;
  }
}

void FoxgloveServer::poll() {
  hub_->io.restart();
  hub_->io.poll();
}

int FoxgloveServer::port() const {
  return hub_->acceptor.local_endpoint().port();
}

std::size_t FoxgloveServer::clients() const {
  return static_cast<std::size_t>(std::count_if(hub_->sessions.begin(), hub_->sessions.end(),
                                                [](const auto& session) { return session->is_open(); }));
}

std::int64_t FoxgloveServer::lost() const {
  return hub_->lost;
}

}  // namespace luminav
