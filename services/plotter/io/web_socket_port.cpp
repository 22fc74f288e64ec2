#include <sys/ioctl.h>
#include <termios.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <stdexcept>

#include "services/plotter/io/ports.hpp"
#include "services/plotter/io/reopening_port.hpp"
#include "services/plotter/io/tcp.hpp"

namespace lookout::plotter {

namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::asio::ip::tcp;

// A client's frame: 2 bytes, up to 8 for the length, 4 for the mask.
constexpr std::size_t kMaxFrameHeadBytes = 14;
// A server that was silent for half of it is sent a ping.
constexpr std::chrono::seconds kMaxSilence{10};

class WebSocketConnection final : public Connection, public std::enable_shared_from_this<WebSocketConnection> {
 public:
  WebSocketConnection(boost::asio::io_context& context, const WebSocketOptions& options, std::shared_ptr<Traffic> traffic)
      : Connection(std::move(traffic)), stream_(context), host_(HostOf(options)), path_(options.path), token_(options.token) {}

  void Connect(const tcp::endpoint& server) {
    boost::system::error_code error;
    socket().open(server.protocol(), error);
    if (error) return Close(error.message());
    PrepareSocket(socket());
    beast::get_lowest_layer(stream_).async_connect(server, [self = shared_from_this()](beast::error_code why) {
      if (self->state() == State::kClosed) return;
      if (why) return self->Close(why.message());
      self->ShakeHands();
    });
  }

 private:
  static std::string HostOf(const WebSocketOptions& options) {
    const bool is_v6 = options.address.find(':') != std::string::npos;
    return (is_v6 ? "[" + options.address + "]" : options.address) + ":" + std::to_string(options.port);
  }

  tcp::socket& socket() { return beast::get_lowest_layer(stream_).socket(); }

  void ShakeHands() {
    // Tick() bounds the time of the whole opening; this timeout is for a server that says that it ends, and does not.
    stream_.set_option(websocket::stream_base::timeout{.handshake_timeout = kMaxOpening, .idle_timeout = kMaxSilence, .keep_alive_pings = true});
    stream_.set_option(websocket::stream_base::decorator([token = token_](websocket::request_type& request) {
      request.set(http::field::user_agent, "lookout");
      if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
    }));
    stream_.read_message_max(0);  // 0: no bound here, as a longer message is refused later without closing the connection
    stream_.text(true);
    stream_.auto_fragment(false);
    stream_.async_handshake(answer_, host_, path_, [self = shared_from_this()](beast::error_code why) {
      if (self->state() == State::kClosed) return;
      if (why) return self->Close(self->RefusalOf(why));
      self->Open();
      self->Read();
    });
  }

  std::string RefusalOf(beast::error_code why) const {
    if (why == beast::error::timeout) return "does not answer";
    if (why != websocket::error::upgrade_declined) return "is no WebSocket: " + why.message();
    std::string text = "refuses with status " + std::to_string(answer_.result_int());
    if (answer_.result() == http::status::unauthorized || answer_.result() == http::status::forbidden) {
      text += token_.empty() ? " (it asks for a token)" : " (is the token right?)";
    } else if (answer_.result() == http::status::not_found) {
      text += " (is the path right?)";
    }
    return text;
  }

  std::string ReasonOf(beast::error_code why) const {
    // However the connection then goes: the server has said that it ends it.
    if (why == websocket::error::closed || stream_.reason()) return "ended the connection";
    return why == beast::error::timeout ? "does not answer any more" : why.message();
  }

  void Read() {
    stream_.async_read_some(bytes_, kMaxTextBytes, [self = shared_from_this()](beast::error_code why, std::size_t) {
      if (self->state() == State::kClosed) return;
      if (why) return self->Close(self->ReasonOf(why));
      self->Take();
      self->Read();
    });
  }

  void Take() {
    if (bytes_.size() > kMaxTextBytes || !stream_.got_text()) {
      is_refused_ = true;
      bytes_.clear();
    }
    if (!stream_.is_message_done()) return;
    if (is_refused_) {
      ++traffic().num_refused;
    } else {
      traffic().Add(beast::buffers_to_string(bytes_.data()));
    }
    bytes_.clear();
    is_refused_ = false;
  }

  void Write(std::string_view message) override {
    num_queued_bytes_ += message.size() + kMaxFrameHeadBytes;
    queue_.emplace_back(message);
    if (queue_.size() == 1) SendOn();
  }

  void SendOn() {
    stream_.async_write(boost::asio::buffer(queue_.front()), [self = shared_from_this()](beast::error_code why, std::size_t) {
      if (self->state() == State::kClosed) return;
      if (why) return self->Close(self->ReasonOf(why));
      self->num_queued_bytes_ -= self->queue_.front().size() + kMaxFrameHeadBytes;
      self->queue_.pop_front();
      if (!self->queue_.empty() && !self->is_late()) self->SendOn();
    });
  }

  std::size_t num_queued_bytes() const override { return num_queued_bytes_; }

  std::size_t num_waiting_bytes() override {
    int num_in_kernel = 0;
    if (ioctl(socket().native_handle(), TIOCOUTQ, &num_in_kernel) < 0) num_in_kernel = 0;
    return num_queued_bytes_ + static_cast<std::size_t>(num_in_kernel);
  }

  void CloseNow() override {
    beast::error_code ignored;
    if (is_late()) socket().set_option(boost::asio::socket_base::linger(true, 0), ignored);
    socket().close(ignored);
  }

  static constexpr std::size_t kMaxTextBytes = std::size_t{64} * 1024;

  websocket::stream<beast::tcp_stream> stream_;
  std::string host_;
  std::string path_;
  std::string token_;
  websocket::response_type answer_;
  beast::flat_buffer bytes_;
  bool is_refused_ = false;        // of the text of which bytes_ is the last part
  std::deque<std::string> queue_;  // the first is being sent
  std::size_t num_queued_bytes_ = 0;
};

class WebSocketPort final : public ReopeningPort {
 public:
  WebSocketPort(std::shared_ptr<Loop> loop, const WebSocketOptions& options)
      : ReopeningPort(std::move(loop), options.name, "WebSocket server " + PlaceOf(options.address, options.port) + options.path,
                      std::chrono::seconds(5)),
        options_(options),
        server_(ParseAddress(options.name, options.address), static_cast<std::uint16_t>(options.port)) {
    // Path and token stand in the request: a blank or a line end in either would make another request of it.
    const auto is_plain = [](char character) { return character > ' ' && character <= '~'; };
    if (options.path.empty() || options.path.front() != '/' || !std::ranges::all_of(options.path, is_plain)) {
      throw std::runtime_error("output " + options.name + ": the path of a WebSocket begins with / and has printable characters without blanks");
    }
    if (!std::ranges::all_of(options.token, is_plain)) {
      throw std::runtime_error("output " + options.name + ": a token has printable characters without blanks");
    }
  }

 private:
  std::shared_ptr<Connection> Open(std::string&) override {
    const auto connection = std::make_shared<WebSocketConnection>(context(), options_, traffic_);
    connection->Connect(server_);
    return connection;
  }

  WebSocketOptions options_;
  tcp::endpoint server_;
};

}  // namespace

std::unique_ptr<Port> MakeWebSocketPort(std::shared_ptr<Loop> loop, const WebSocketOptions& options) {
  return std::make_unique<WebSocketPort>(std::move(loop), options);
}

}  // namespace lookout::plotter
