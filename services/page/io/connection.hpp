// A TCP connection that asks by HTTP, one request after the other, until it is closed or becomes a WebSocket.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "services/page/io/hub.hpp"

namespace lookout::page {

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  /// In the order in which they are given up for others.
  enum class Stage { kSilent, kIdle, kBusy };  // it has asked for nothing yet; waits between two requests; is being answered

  Connection(Hub& hub, boost::asio::ip::tcp::socket socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Start();

  Stage stage() const { return stage_; }
  SteadyTime since() const { return since_; }  // of the stage
  /// Of the other side, numeric.
  const std::string& remote() const { return remote_; }
  bool is_let_go() const { return is_let_go_; }

  /// Makes room for another one.
  void LetGo();

 private:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;
  using Response = boost::beast::http::response<boost::beast::http::span_body<const std::uint8_t>>;
  using Serializer = boost::beast::http::response_serializer<boost::beast::http::span_body<const std::uint8_t>>;

  void Enter(Stage stage);
  void AwaitRequest(std::chrono::seconds patience);
  void ReadRequest();
  void Handle();
  void Serve(std::string_view path);
  void ServeFromDisk(std::string_view path);
  bool MayCommand();
  void Acknowledge();
  void TakeOrder();
  void BecomeWebSocket();

  std::string_view Header(boost::beast::http::field name) const;
  bool IsAllowed();

  /// Answers with a line of text. @param count  what it counts as; empty: nothing
  void Refuse(boost::beast::http::status status, std::string_view reason, std::string_view count);
  void Send(boost::beast::http::status status, Content content, std::string_view cache_control);
  void Write();
  void Linger();

  Hub& hub_;
  boost::beast::tcp_stream stream_;
  Place place_;
  std::string remote_;
  Stage stage_ = Stage::kSilent;
  SteadyTime since_ = std::chrono::steady_clock::now();
  bool is_let_go_ = false;
  OwnHosts own_hosts_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  Request request_;
  std::string reason_;  // bytes of a refusal
  Content content_;     // being sent
  std::optional<Response> response_;
  std::optional<Serializer> serializer_;
};

}  // namespace lookout::page
