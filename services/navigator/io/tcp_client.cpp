#include "services/navigator/io/tcp_client.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lookout::navigator {

namespace {

// A server that lost its power says nothing any more: it is asked after 10 s of silence, and given up when it does not answer three times.
constexpr int kSecondsToFirstProbe = 10;
constexpr int kSecondsBetweenProbes = 5;
constexpr int kNumProbes = 3;

void KeepAlive(int descriptor) {
  const auto set = [descriptor](int level, int option, int value) { setsockopt(descriptor, level, option, &value, sizeof value); };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, kSecondsToFirstProbe);
  set(IPPROTO_TCP, TCP_KEEPINTVL, kSecondsBetweenProbes);
  set(IPPROTO_TCP, TCP_KEEPCNT, kNumProbes);
}

}  // namespace

TcpClient::TcpClient(const std::string& name, const std::string& address, int port, const std::string& kind)
    : StreamSource(name, kind + " " + address + " port " + std::to_string(port)), address_(address), port_(std::to_string(port)) {}

int TcpClient::Open(std::string& fault) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(address_.c_str(), port_.c_str(), &hints, &found); error != 0) {
    fault = gai_strerror(error);
    return kNone;
  }
  const int descriptor = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor >= 0) KeepAlive(descriptor);
  const bool is_begun = descriptor >= 0 && (connect(descriptor, found->ai_addr, found->ai_addrlen) == 0 || errno == EINPROGRESS);
  if (!is_begun) fault = std::strerror(errno);
  freeaddrinfo(found);
  if (is_begun) return descriptor;
  if (descriptor >= 0) close(descriptor);
  return kNone;
}

}  // namespace lookout::navigator
