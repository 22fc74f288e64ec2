#include "services/plotter/io/tcp.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/socket_base.hpp>
#include <chrono>
#include <optional>
#include <stdexcept>

namespace lookout::plotter {

namespace {

using boost::asio::ip::tcp;

// Probes for a computer that lost its power: the first after 10 s of silence; the computer is given up when it does not answer three of them.
constexpr int kSecondsToFirstProbe = 10;
constexpr int kSecondsBetweenProbes = 5;
constexpr int kNumProbes = 3;
// Bytes that are not acknowledged after this end the connection.
constexpr int kUserTimeoutMs = 20'000;
// Linux doubles it for its own needs. Some hundred lines, or one large delta.
constexpr int kSendBufferBytes = 16 * 1024;
// A reset arrives at a receiver that was heard of within this time.
constexpr unsigned kHeardMs = 1000;

std::optional<tcp_info> InfoOf(tcp::socket& socket) {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (getsockopt(socket.native_handle(), IPPROTO_TCP, TCP_INFO, &info, &size) < 0) return std::nullopt;
  return info;
}

}  // namespace

boost::asio::ip::address ParseAddress(const std::string& name, const std::string& address) {
  boost::system::error_code error;
  auto parsed = boost::asio::ip::make_address(address, error);
  if (error) throw std::runtime_error("output " + name + ": '" + address + "' is no numeric address (as 192.168.1.5 or fd00::5)");
  return parsed;
}

std::string PlaceOf(const std::string& address, int port) { return address + " port " + std::to_string(port); }

void PrepareSocket(tcp::socket& socket) {
  const auto set = [&socket](int level, int option, int value) { setsockopt(socket.native_handle(), level, option, &value, sizeof value); };
  set(SOL_SOCKET, SO_SNDBUF, kSendBufferBytes);
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, kSecondsToFirstProbe);
  set(IPPROTO_TCP, TCP_KEEPINTVL, kSecondsBetweenProbes);
  set(IPPROTO_TCP, TCP_KEEPCNT, kNumProbes);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, kUserTimeoutMs);
  set(IPPROTO_TCP, TCP_NODELAY, 1);
}

TcpConnection::TcpConnection(tcp::socket socket, Made made, std::shared_ptr<Traffic> traffic)
    : StreamConnection(std::move(socket), std::move(traffic)), made_(made) {
  PrepareSocket(stream());
}

void TcpConnection::Connect(const tcp::endpoint& endpoint) {
  stream().async_connect(endpoint, [self = shared_from_this()](boost::system::error_code error) {
    if (self->state() == State::kClosed) return;
    if (error) return self->Close(error.message());
    self->Start();
  });
}

void TcpConnection::PrepareClose() {
  if (!is_late()) return;
  // By a reset: bytes that wait in the kernel are dropped.
  boost::system::error_code ignored;
  stream().set_option(boost::asio::socket_base::linger(true, 0), ignored);
}

void TcpConnection::OnEnd() {
  if (made_ == Made::kByUs) return Close("ended the connection");
  is_half_closed_ = true;
}

bool TcpConnection::IsReachable() {
  // A reset is sent once. Lost on a network that is down, it would leave a client that only reads waiting for ever.
  if (made_ == Made::kByUs) return true;
  const auto info = InfoOf(stream());
  return !info || info->tcpi_last_ack_recv <= kHeardMs;
}

void TcpConnection::Check() {
  if (!is_half_closed_) return;
  const auto info = InfoOf(stream());  // nobody reads any more, so only this tells of a reset connection
  if (!info || info->tcpi_state != TCP_CLOSE_WAIT) Close("ended the connection");
}

}  // namespace lookout::plotter
