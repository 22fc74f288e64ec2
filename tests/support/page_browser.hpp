// What a browser says to a page on loopback, without a browser: HTTP and the WebSocket.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <string>

namespace lookout::support {

class PageBrowser {
 public:
  explicit PageBrowser(int port) : port_(port) {}

  std::string Origin() const { return "http://localhost:" + std::to_string(port_); }

  struct Reply {
    int status = 0;
    std::string body;
    std::string policy;  // Content-Security-Policy
  };
  /// Empty values of `host`, `origin` and `token`: ours, none, none.
  Reply Ask(const std::string& method, const std::string& target, const std::string& body = {}, const std::string& host = {},
            const std::string& origin = {}, const std::string& token = {}) const {
    namespace http = boost::beast::http;
    boost::asio::io_context context;
    boost::beast::tcp_stream stream(context);
    stream.expires_after(std::chrono::seconds(10));
    stream.connect({boost::asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port_)});
    http::request<http::string_body> request(http::string_to_verb(method), target, 11);
    request.set(http::field::host, host.empty() ? "localhost:" + std::to_string(port_) : host);
    if (!origin.empty()) request.set(http::field::origin, origin);
    if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
    request.body() = body;
    request.prepare_payload();
    http::write(stream, request);
    boost::beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(stream, buffer, response);
    return {static_cast<int>(response.result_int()), response.body(), std::string(response["Content-Security-Policy"])};
  }

 private:
  int port_;
};

/// One tab: its WebSocket. Read blocks for at most 10 s.
class PageTab {
 public:
  explicit PageTab(int port) : socket_(context_) {
    namespace websocket = boost::beast::websocket;
    boost::beast::get_lowest_layer(socket_).expires_after(std::chrono::seconds(10));
    boost::beast::get_lowest_layer(socket_).connect({boost::asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)});
    const std::string origin = "http://localhost:" + std::to_string(port);
    socket_.set_option(websocket::stream_base::decorator([origin](websocket::request_type& request) {
      request.set(boost::beast::http::field::origin, origin);
      request.set(boost::beast::http::field::sec_websocket_protocol, "lookout.page.v1");
    }));
    socket_.handshake("localhost:" + std::to_string(port), "/socket");
  }

  void Say(const std::string& text) {
    socket_.text(true);
    socket_.write(boost::asio::buffer(text));
  }

  struct Frame {
    bool is_text = false;
    std::string bytes;
  };
  Frame Read() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    return {socket_.got_text(), boost::beast::buffers_to_string(buffer.data())};
  }

 private:
  boost::asio::io_context context_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
};

}  // namespace lookout::support
