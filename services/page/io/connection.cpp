#include "services/page/io/connection.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <utility>

#include "services/page/core/request.hpp"
#include "services/page/io/client.hpp"

namespace lookout::page {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

namespace {

constexpr std::string_view kAcknowledgePath = "/acknowledge";
constexpr std::string_view kOrderPath = "/order";
bool IsCommand(std::string_view path) { return path == kAcknowledgePath || path == kOrderPath; }

constexpr std::chrono::seconds kFirstPatience{5};
constexpr std::chrono::seconds kKeepAlive{15};
constexpr std::chrono::seconds kMaxReading{5};
constexpr std::chrono::seconds kMaxWriting{5};
constexpr std::size_t kSlowestBytesPerSecond = 32 * 1024;  // a large answer may take longer
constexpr std::chrono::seconds kMaxLingering{2};
constexpr std::size_t kMaxHeadBytes = 8 * 1024;
constexpr std::size_t kMaxBodyBytes = 4 * 1024;
constexpr std::string_view kProtocol = "lookout.page.v1";
constexpr std::string_view kText = "text/plain; charset=utf-8";
constexpr std::string_view kAskAgain = "no-cache";
constexpr std::string_view kKeepNothing = "no-store";
constexpr std::string_view kKeepTile = "private, max-age=3600";

Bytes BytesOf(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

std::string HostTextOf(const asio::ip::address& address) {
  if (address.is_v4()) return address.to_string();
  auto v6 = address.to_v6();
  if (v6.is_v4_mapped()) return asio::ip::make_address_v4(asio::ip::v4_mapped, v6).to_string();
  v6.scope_id(0);
  return "[" + v6.to_string() + "]";
}

bool IsRead(http::verb method) { return method == http::verb::get || method == http::verb::head; }

}  // namespace

Connection::Connection(Hub& hub, asio::ip::tcp::socket socket)
    : hub_(hub), stream_(std::move(socket)), place_(hub.counts, "connections"), own_hosts_(hub.own_hosts) {
  // Where the server listens on every address, this is the one by which it was reached.
  error_code error;
  const auto local = stream_.socket().local_endpoint(error);
  if (!error) own_hosts_.names.push_back(HostTextOf(local.address()));
  const auto remote = stream_.socket().remote_endpoint(error);
  if (!error) remote_ = HostTextOf(remote.address());
  hub_.connections.insert(this);
}

Connection::~Connection() { hub_.connections.erase(this); }

void Connection::Start() { AwaitRequest(kFirstPatience); }

void Connection::LetGo() {
  is_let_go_ = true;
  stream_.close();  // ends waiting handlers with an error
}

void Connection::Enter(Stage stage) {
  stage_ = stage;
  since_ = std::chrono::steady_clock::now();
}

// Between two requests a connection may stay idle for longer than one request may take.
void Connection::AwaitRequest(std::chrono::seconds patience) {
  parser_.emplace();
  parser_->header_limit(kMaxHeadBytes);
  parser_->body_limit(kMaxBodyBytes);
  if (buffer_.size() > 0) return ReadRequest();
  stream_.expires_after(patience);
  stream_.async_read_some(buffer_.prepare(kMaxHeadBytes), [self = shared_from_this()](error_code error, std::size_t num_bytes) {
    if (error == beast::error::timeout && self->stage_ == Stage::kSilent) self->hub_.counts->Add("connections_silent");
    if (error) return;
    self->buffer_.commit(num_bytes);
    self->ReadRequest();
  });
}

void Connection::ReadRequest() {
  stream_.expires_after(kMaxReading);
  http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) {
      self->request_ = self->parser_->release();
      self->hub_.counts->Add("requests");
      self->Enter(Stage::kBusy);
      return self->Handle();
    }
    if (error == beast::error::timeout) return self->hub_.counts->Add("requests_late");
    if (error == http::error::end_of_stream || error == http::error::partial_message ||
        error.category() != http::make_error_code(http::error::end_of_stream).category())
      return;
    self->request_ = {};
    self->request_.keep_alive(false);
    if (error == http::error::header_limit)
      return self->Refuse(http::status::request_header_fields_too_large, "the head is too large", "refused_request");
    if (error == http::error::body_limit) return self->Refuse(http::status::payload_too_large, "the body is too large", "refused_request");
    self->Refuse(http::status::bad_request, "this is no request", "refused_request");
  });
}

std::string_view Connection::Header(http::field name) const {
  const auto value = request_[name];
  return {value.data(), value.size()};
}

void Connection::Handle() {
  if (!IsAllowed()) return;
  const auto target = request_.target();
  const auto path = std::string_view(target.data(), target.size()).substr(0, std::min(target.find('?'), target.size()));
  if (IsCommand(path)) {
    if (request_.method() != http::verb::post) return Refuse(http::status::method_not_allowed, "this takes POST", "refused_request");
    return path == kAcknowledgePath ? Acknowledge() : TakeOrder();
  }
  if (!IsRead(request_.method())) return Refuse(http::status::method_not_allowed, "this takes GET", "refused_request");
  if (path == "/socket") return BecomeWebSocket();
  Serve(path);
}

bool Connection::IsAllowed() {
  if (request_.count(http::field::host) != 1 || !IsOwnHost(Header(http::field::host), own_hosts_)) {
    Refuse(http::status::misdirected_request, "the host that you ask for is none of this server's names", "refused_host");
    return false;
  }
  const auto num_origins = request_.count(http::field::origin);
  const bool needs_origin = request_.method() == http::verb::post || request_.target() == "/socket" || request_.target().starts_with("/socket?");
  if (num_origins > 1 || (num_origins == 0 && needs_origin) || (num_origins == 1 && !IsOwnOrigin(Header(http::field::origin), own_hosts_))) {
    Refuse(http::status::forbidden, "this page is not from this server", "refused_origin");
    return false;
  }
  return true;
}

void Connection::Serve(std::string_view path) {
  if (path.starts_with("/tiles")) return ServeFromDisk(path);
  Content content;
  if (!hub_.assets.Find(path, AcceptsGzip(Header(http::field::accept_encoding)), content))
    return Refuse(http::status::not_found, "there is no such page", "refused_request");
  const auto known = Header(http::field::if_none_match);
  if (HoldsWord(known, content.tag) || HoldsWord(known, "W/" + content.tag)) {
    content.bytes = {};
    return Send(http::status::not_modified, std::move(content), kAskAgain);
  }
  Send(http::status::ok, std::move(content), kAskAgain);
}

void Connection::ServeFromDisk(std::string_view path) {
  TileAddress address;
  const bool is_list = path == "/tiles.json";
  const bool is_tile = ParseTilePath(path, address) && hub_.parts.tile;
  if (!is_list && !is_tile) return Refuse(http::status::not_found, "there is no such map", "refused_request");
  // A missing tile is no fault: a 404 would stand as one in the browser's console, for each tile.
  if (is_list && !hub_.parts.tiles_text) return Send(http::status::no_content, {}, kAskAgain);
  stream_.expires_never();
  asio::post(hub_.disk, [self = shared_from_this(), address, is_list]() mutable {
    auto& hub = self->hub_;
    std::optional<Tile> tile;
    bool is_fault = false;
    try {
      if (!is_list) tile = hub.parts.tile(address.z, address.x, address.y);
      if (is_list) {
        const auto text = hub.parts.tiles_text();
        tile = Tile{"application/json", {text.begin(), text.end()}};
      }
    } catch (const std::exception&) {
      is_fault = true;
    }
    asio::post(hub.context, [self = std::move(self), tile = std::move(tile), is_fault, is_list]() mutable {
      if (is_fault) return self->Refuse(http::status::internal_server_error, "the map cannot be read", "faults");
      if (!tile || tile->bytes.empty()) return self->Send(http::status::no_content, {}, kAskAgain);
      self->reason_ = std::move(tile->content_type);
      auto owner = std::make_shared<const std::vector<std::uint8_t>>(std::move(tile->bytes));
      const Bytes bytes = *owner;
      self->Send(http::status::ok, {self->reason_, bytes, std::move(owner), {}, false}, is_list ? kAskAgain : kKeepTile);
    });
  });
}

bool Connection::MayCommand() {
  if (request_.count(http::field::authorization) != 1 || !HasToken(Header(http::field::authorization), hub_.options.token)) {
    Refuse(http::status::unauthorized, "this takes the token of the link that the server has printed", "refused_token");
    return false;
  }
  if (!hub_.may_acknowledge()) {
    Refuse(http::status::conflict, "a log is shown: there is nothing to acknowledge", "refused_request");
    return false;
  }
  return true;
}

void Connection::Acknowledge() {
  if (!MayCommand()) return;
  const auto acknowledgement = ParseAcknowledgement(request_.body());
  if (!acknowledgement) return Refuse(http::status::bad_request, "this is no acknowledgement", "refused_request");
  hub_.parts.acknowledge(*acknowledgement);
  hub_.counts->Add("acknowledgements");
  Refuse(http::status::accepted, "sent", {});
}

void Connection::TakeOrder() {
  if (!MayCommand()) return;
  const auto order = ParseOrder(request_.body());
  if (!order) return Refuse(http::status::bad_request, "this is no order", "refused_request");
  hub_.parts.order(*order);
  hub_.counts->Add("orders");
  Refuse(http::status::accepted, "sent", {});
}

void Connection::BecomeWebSocket() {
  if (request_.method() != http::verb::get || !beast::websocket::is_upgrade(request_) || buffer_.size() > 0)
    return Refuse(http::status::upgrade_required, "this takes a WebSocket", "refused_request");
  if (!HoldsWord(Header(http::field::sec_websocket_protocol), kProtocol))
    return Refuse(http::status::bad_request, "the page is of another version: load it again", "refused_request");
  if (hub_.counts->Of("clients") >= hub_.options.max_clients)
    return Refuse(http::status::service_unavailable, "as many look at this page as may", "refused_full");
  stream_.expires_never();
  std::make_shared<Client>(hub_, std::move(stream_), std::move(place_))->Start(request_);
}

void Connection::Refuse(http::status status, std::string_view reason, std::string_view count) {
  if (!count.empty()) hub_.counts->Add(count);
  reason_ = std::string(reason) + "\n";
  Send(status, {kText, BytesOf(reason_), nullptr, {}, false}, kKeepNothing);
}

void Connection::Send(http::status status, Content content, std::string_view cache_control) {
  const auto view = [](std::string_view text) { return boost::string_view(text.data(), text.size()); };
  content_ = std::move(content);
  response_.emplace(status, 11);
  auto& response = *response_;
  const auto host = Header(http::field::host);
  for (const auto& [name, value] : SecurityHeaders(IsOwnHost(host, own_hosts_) ? host : "localhost")) response.set(view(name), value);
  response.set(http::field::cache_control, view(cache_control));
  if (status != http::status::no_content) response.set(http::field::content_type, view(content_.type));
  if (!content_.tag.empty()) {
    response.set(http::field::etag, content_.tag);
    response.set(http::field::vary, "Accept-Encoding");
  }
  if (content_.is_gzip) response.set(http::field::content_encoding, "gzip");
  if (status == http::status::unauthorized) response.set(http::field::www_authenticate, "Bearer");
  if (status == http::status::method_not_allowed)
    response.set(http::field::allow, IsCommand({request_.target().data(), request_.target().size()}) ? "POST" : "GET, HEAD");
  if (status == http::status::upgrade_required) response.set(http::field::upgrade, "websocket");
  if (status == http::status::service_unavailable) response.set(http::field::retry_after, "5");
  response.keep_alive(request_.keep_alive() && !hub_.is_ending);
  if (status != http::status::not_modified && status != http::status::no_content) response.content_length(content_.bytes.size());
  response.body() = {content_.bytes.data(), content_.bytes.size()};
  Write();
}

void Connection::Write() {
  const bool is_head_only = request_.method() == http::verb::head;
  const auto num_slow_seconds = is_head_only ? 0 : content_.bytes.size() / kSlowestBytesPerSecond;
  stream_.expires_after(kMaxWriting + std::chrono::seconds(num_slow_seconds));
  serializer_.emplace(*response_);
  auto on_sent = [self = shared_from_this()](error_code error, std::size_t) {
    if (error == beast::error::timeout) self->hub_.counts->Add("answers_late");
    if (error) return;
    self->content_ = {};
    self->Enter(Stage::kIdle);
    if (!self->response_->keep_alive()) return self->Linger();
    self->AwaitRequest(kKeepAlive);
  };
  if (is_head_only) return http::async_write_header(stream_, *serializer_, std::move(on_sent));
  http::async_write(stream_, *serializer_, std::move(on_sent));
}

// A socket that is closed while something to read is left takes back the sent bytes: the browser would not see the refusal.
void Connection::Linger() {
  error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  stream_.expires_after(kMaxLingering);
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(kMaxHeadBytes), [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->stream_.close();
  });
}

}  // namespace lookout::page
