// One connection to the server for viewers: a request of HTTP, then a WebSocket.
#pragma once

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "services/page/core/viewer_protocol.hpp"
#include "services/page/core/viewer_queue.hpp"
#include "services/page/io/counts.hpp"
#include "services/page/io/foxglove_server.hpp"

namespace lookout::page {

class Viewer;

/// State that the connections of one server share. All but the counts and the watched channels is of the server's thread.
struct ViewerHub {
  explicit ViewerHub(FoxgloveOptions server_options)
      : options(std::move(server_options)),
        advertisement(AdvertiseText(options.channels)),
        counts(std::make_shared<Counts>()),
        num_watching(options.channels.size()) {}

  const FoxgloveOptions options;
  const std::string advertisement;
  const std::shared_ptr<Counts> counts;
  std::vector<std::atomic<int>> num_watching;  // viewers, by channel
  std::set<std::shared_ptr<Viewer>> viewers = {};
  bool is_ending = false;
  boost::asio::io_context context{1};  // last, so that work that waits in the context is destroyed first
};

class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Viewer(ViewerHub& hub, boost::asio::ip::tcp::socket socket);

  void Start();
  void Offer(const ViewerMessage& message);

  /// Once a second: asks whether it is there, and lets it go when it is not.
  void Tick(Time now);

  void Close(boost::beast::websocket::close_code code, const char* reason);

 private:
  using Subscriptions = std::map<std::uint32_t, std::size_t>;  // channel index by number of the subscription

  void Handle();
  void Refuse(boost::beast::http::status status, std::string reason, std::string_view count);
  void Accept(std::string_view protocol);
  void Read();
  void OnText(std::string_view text);
  void Do(const Subscribe& request);
  void Do(const Unsubscribe& request);
  void Do(const NotServed& request);
  void Do(const NoRequest& request);
  void Unwatch(Subscriptions::iterator subscription);
  void Tell(std::string text);
  void SendOn();
  void OnSent(boost::system::error_code error);
  void Gone();

  ViewerHub& hub_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Place connection_place_;
  std::optional<Place> client_place_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  boost::beast::http::request<boost::beast::http::empty_body> request_;
  boost::beast::http::response<boost::beast::http::string_body> refusal_;

  bool is_open_ = false;
  bool is_closing_ = false;
  bool is_gone_ = false;
  bool is_reading_ = false;
  bool is_writing_ = false;
  bool is_pinging_ = false;
  Time closing_since_{};
  Time heard_{};
  Time pinged_{};
  int num_faults_ = 0;

  Subscriptions subscriptions_;
  ViewerQueue queue_;
  std::int64_t num_dropped_told_ = 0;
  std::deque<std::string> texts_;
  std::string sending_text_;
  std::array<std::uint8_t, kMessageDataHeadBytes> sending_head_{};
  SharedText sending_bytes_;
};

}  // namespace lookout::page
