#include "services/page/io/listener.hpp"

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "common/io/network.hpp"

namespace lookout::page {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::chrono::milliseconds kPauseAfterFault{100};
constexpr int kSendBufferBytes = 256 * 1024;

}  // namespace

Listener::Listener(asio::io_context& context, Options options, Handlers handlers)
    : options_(std::move(options)), handlers_(std::move(handlers)), acceptor_(context), pause_(context) {
  const auto fault = Listen();
  if (!fault.empty() && !options_.waits_for_port) throw std::runtime_error(fault);
  if (fault.empty()) {
    Accept();
  } else {
    ListenLater();
  }
}

std::string Listener::Listen() {
  std::string fault;
  try {
    const tcp::endpoint endpoint(asio::ip::make_address(options_.bind_address), static_cast<std::uint16_t>(options_.port));
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
    if (handlers_.on_listening) handlers_.on_listening(acceptor_.local_endpoint());
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    error_code ignored;
    acceptor_.close(ignored);
    fault = options_.served + " cannot be served on " + options_.bind_address + " port " + std::to_string(options_.port) + ": " +
            io::CannotListenText(error.code().value(), options_.port);
  }
  const std::lock_guard lock(mutex_);
  fault_ = fault;
  return fault;
}

// The program that has the port may end, and an address may come later.
void Listener::ListenLater() {
  pause_.expires_after(io::kListenPause);
  pause_.async_wait([this](error_code) {
    if (is_closed_) return;
    if (Listen().empty()) return Accept();
    ListenLater();
  });
}

void Listener::Accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (is_closed_) return;
    if (error) {
      // No descriptor is left, say: others will close some.
      handlers_.on_fault();
      pause_.expires_after(kPauseAfterFault);
      pause_.async_wait([this](error_code) {
        if (!is_closed_) Accept();
      });
      return;
    }
    Accept();
    handlers_.on_socket(std::move(socket));
  });
}

void Listener::Close() {
  is_closed_ = true;
  error_code ignored;
  acceptor_.close(ignored);
  pause_.cancel();
}

std::string Listener::Fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

void RunThroughFaults(asio::io_context& context, const std::function<void()>& on_fault) {
  while (true) {
    try {
      context.run();
      return;
    } catch (...) {
      on_fault();
    }
  }
}

void SetServedOptions(tcp::socket& socket) {
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
}

}  // namespace lookout::page
