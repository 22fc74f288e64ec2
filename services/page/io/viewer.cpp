#include "services/page/io/viewer.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <utility>

namespace lookout::page {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

namespace {

constexpr std::chrono::seconds kMaxViewerHandshake{5};
constexpr std::chrono::seconds kViewerPingPeriod{5};
constexpr std::chrono::seconds kMaxViewerSilence{20};
constexpr std::chrono::seconds kMaxViewerClosing{2};
constexpr int kMaxViewerFaults = 10;
constexpr std::size_t kMaxViewerTexts = 32;
constexpr std::size_t kMaxViewerHeadBytes = std::size_t{8} * 1024;

}  // namespace

Viewer::Viewer(ViewerHub& hub, asio::ip::tcp::socket socket)
    : hub_(hub),
      socket_(std::move(socket)),
      connection_place_(hub.counts, "foxglove_connections"),
      heard_(std::chrono::steady_clock::now()),
      pinged_(heard_) {}

void Viewer::Start() {
  hub_.viewers.insert(shared_from_this());
  auto& stream = beast::get_lowest_layer(socket_);
  stream.expires_after(kMaxViewerHandshake);
  parser_.emplace();
  parser_->header_limit(kMaxViewerHeadBytes);
  http::async_read(stream, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
    if (self->is_gone_) return;
    if (!error) {
      self->request_ = self->parser_->release();
      return self->Handle();
    }
    if (error.category() == http::make_error_code(http::error::end_of_stream).category() && error != http::error::end_of_stream)
      self->hub_.counts->Add("foxglove_refused_request");
    self->Gone();
  });
}

void Viewer::Handle() {
  const auto header = [this](http::field name) {
    const auto value = request_[name];
    return std::string_view(value.data(), value.size());
  };
  const auto& allowed = hub_.options.allowed_origins;
  const auto num_origins = request_.count(http::field::origin);
  if (num_origins > 1 || (num_origins == 1 && std::ranges::find(allowed, header(http::field::origin)) == allowed.end()))
    return Refuse(http::status::forbidden, "pages of this origin may not ask: allowed_origin in page.txtpb", "foxglove_refused_origin");
  if (!websocket::is_upgrade(request_) || buffer_.size() > 0)
    return Refuse(http::status::upgrade_required, "this takes a WebSocket of Foxglove", "foxglove_refused_request");
  const auto protocol = ChooseViewerProtocol(header(http::field::sec_websocket_protocol));
  if (protocol.empty()) return Refuse(http::status::bad_request, "this speaks foxglove.sdk.v1 and foxglove.websocket.v1", "foxglove_refused_request");
  if (hub_.counts->Of("foxglove_clients") >= hub_.options.max_clients)
    return Refuse(http::status::service_unavailable, "as many viewers look as may", "foxglove_refused_full");
  Accept(protocol);
}

void Viewer::Refuse(http::status status, std::string reason, std::string_view count) {
  hub_.counts->Add(count);
  refusal_ = {status, 11};
  refusal_.set(http::field::content_type, "text/plain; charset=utf-8");
  if (status == http::status::upgrade_required) refusal_.set(http::field::upgrade, "websocket");
  refusal_.keep_alive(false);
  refusal_.body() = std::move(reason) + "\n";
  refusal_.prepare_payload();
  auto& stream = beast::get_lowest_layer(socket_);
  http::async_write(stream, refusal_, [self = shared_from_this()](error_code, std::size_t) {
    error_code ignored;
    beast::get_lowest_layer(self->socket_).socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    self->Gone();
  });
}

void Viewer::Accept(std::string_view protocol) {
  client_place_.emplace(hub_.counts, "foxglove_clients");
  beast::get_lowest_layer(socket_).expires_never();
  socket_.set_option(websocket::stream_base::timeout{kMaxViewerHandshake, websocket::stream_base::none(), false});
  socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
    response.set(http::field::sec_websocket_protocol, boost::string_view(protocol.data(), protocol.size()));
  }));
  socket_.auto_fragment(false);
  socket_.read_message_max(kMaxViewerRequestBytes);
  socket_.control_callback([this](websocket::frame_type, boost::string_view) { heard_ = std::chrono::steady_clock::now(); });
  socket_.async_accept(request_, [self = shared_from_this()](error_code error) {
    if (error) return self->Gone();
    self->hub_.counts->Add("foxglove_openings");
    self->is_open_ = true;
    self->Tell(ServerInfoText(self->hub_.options.name, self->hub_.options.session));
    self->Tell(self->hub_.advertisement);
    self->Read();
  });
}

void Viewer::Read() {
  if (is_reading_ || is_closing_ || is_gone_) return;
  is_reading_ = true;
  socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
    self->is_reading_ = false;
    if (error) {
      if (error != websocket::error::closed && error.category() == websocket::make_error_code(websocket::error::closed).category())
        self->hub_.counts->Add("foxglove_client_faults");
      return self->Gone();
    }
    self->heard_ = std::chrono::steady_clock::now();
    const auto bytes = self->buffer_.cdata();
    if (self->socket_.got_text()) {
      self->OnText({static_cast<const char*>(bytes.data()), bytes.size()});
    } else {
      self->Do(NotServed{"messages of clients and calls of services"});  // all that is binary
    }
    self->buffer_.clear();
    // A viewer that does not read what it is told is not listened to.
    if (self->texts_.size() < kMaxViewerTexts) self->Read();
  });
}

void Viewer::OnText(std::string_view text) {
  if (is_closing_) return;
  std::visit([this](const auto& request) { Do(request); }, ParseViewerRequest(text));
}

void Viewer::Do(const Subscribe& request) {
  for (const auto& [id, channel] : request.subscriptions) {
    const auto index = channel - kFirstViewerChannel;  // of 0: greater than any
    const auto is_same = [index](const auto& one) { return one.second == index; };
    if (index >= hub_.options.channels.size()) {
      Do(NoRequest{"there is no channel " + std::to_string(channel)});
    } else if (subscriptions_.contains(id) || std::ranges::any_of(subscriptions_, is_same)) {
      Tell(
          StatusText(StatusLevel::kWarning, "subscription " + std::to_string(id) + ", or channel " + std::to_string(channel) + ", is taken already"));
    } else {
      subscriptions_.emplace(id, index);
      ++hub_.num_watching[index];
    }
    if (is_closing_) return;
  }
}

void Viewer::Do(const Unsubscribe& request) {
  for (const auto id : request.subscriptions) {
    if (const auto found = subscriptions_.find(id); found != subscriptions_.end()) Unwatch(found);
  }
}

void Viewer::Unwatch(Subscriptions::iterator subscription) {
  --hub_.num_watching[subscription->second];
  queue_.Forget(subscription->second);
  subscriptions_.erase(subscription);
}

void Viewer::Do(const NotServed& request) {
  hub_.counts->Add("foxglove_not_served");
  Tell(StatusText(StatusLevel::kError, "this server only shows: " + request.op + " is refused"));
}

void Viewer::Do(const NoRequest& request) {
  hub_.counts->Add("foxglove_client_faults");
  if (++num_faults_ > kMaxViewerFaults) return Close(websocket::close_code::policy_error, "too much that is no request");
  Tell(StatusText(StatusLevel::kWarning, request.reason));
}

void Viewer::Offer(const ViewerMessage& message) {
  const auto is_of_it = [&message](const auto& one) { return one.second == message.channel; };
  if (!is_open_ || is_closing_ || is_gone_ || std::ranges::none_of(subscriptions_, is_of_it)) return;
  queue_.Put(message);
  hub_.counts->Add("foxglove_dropped", queue_.num_dropped() - num_dropped_told_);
  num_dropped_told_ = queue_.num_dropped();
  SendOn();
}

void Viewer::Tell(std::string text) {
  texts_.push_back(std::move(text));
  SendOn();
}

void Viewer::SendOn() {
  if (!is_open_ || is_closing_ || is_gone_ || is_writing_) return;
  if (!texts_.empty()) {
    is_writing_ = true;
    sending_text_ = std::move(texts_.front());
    texts_.pop_front();
    socket_.text(true);
    return socket_.async_write(asio::buffer(std::as_const(sending_text_)),
                               [self = shared_from_this()](error_code error, std::size_t) { self->OnSent(error); });
  }
  const auto message = queue_.Take();
  if (!message) return;
  // Messages of a channel that is not subscribed any more are forgotten, so there is one.
  const auto subscription = std::ranges::find_if(subscriptions_, [&message](const auto& one) { return one.second == message->channel; });
  is_writing_ = true;
  sending_head_ = MessageDataHead(subscription->first, message->time);
  sending_bytes_ = message->bytes;
  hub_.counts->Add("foxglove_sent");
  socket_.binary(true);
  const std::array<asio::const_buffer, 2> buffers{asio::buffer(std::as_const(sending_head_)), asio::buffer(*sending_bytes_)};
  socket_.async_write(buffers, [self = shared_from_this()](error_code error, std::size_t) { self->OnSent(error); });
}

void Viewer::OnSent(error_code error) {
  is_writing_ = false;
  sending_bytes_ = nullptr;
  if (error) return Gone();
  SendOn();
  if (texts_.size() < kMaxViewerTexts) Read();
}

void Viewer::Tick(Time now) {
  if (is_gone_ || !is_open_) return;
  const bool is_silent = now - heard_ > kMaxViewerSilence;
  if (is_silent) hub_.counts->Add("foxglove_clients_silent");
  if (is_silent || (is_closing_ && now - closing_since_ > kMaxViewerClosing)) return Gone();
  if (is_closing_ || is_pinging_ || now - pinged_ < kViewerPingPeriod) return;
  is_pinging_ = true;
  pinged_ = now;
  socket_.async_ping({}, [self = shared_from_this()](error_code) { self->is_pinging_ = false; });
}

void Viewer::Close(websocket::close_code code, const char* reason) {
  if (is_closing_ || is_gone_) return;
  if (!is_open_) return Gone();
  is_closing_ = true;
  closing_since_ = std::chrono::steady_clock::now();
  socket_.async_close({code, reason}, [self = shared_from_this()](error_code) { self->Gone(); });
}

void Viewer::Gone() {
  if (is_gone_) return;
  is_gone_ = true;
  while (!subscriptions_.empty()) Unwatch(subscriptions_.begin());
  texts_.clear();
  beast::get_lowest_layer(socket_).close();
  client_place_.reset();
  hub_.viewers.erase(shared_from_this());
}

}  // namespace lookout::page
