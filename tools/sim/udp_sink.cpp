#include "tools/sim/udp_sink.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace lookout::sim {

UdpSink::UdpSink(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (code != 0) throw std::runtime_error(host + ": " + gai_strerror(code));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof(address));
  address_ = address.sin_addr.s_addr;
  freeaddrinfo(found);

  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) throw std::runtime_error(std::string("socket: ") + std::strerror(errno));
  const int allowed = 1;
  setsockopt(socket_, SOL_SOCKET, SO_BROADCAST, &allowed, sizeof(allowed));
}

UdpSink::~UdpSink() {
  if (socket_ >= 0) close(socket_);
}

void UdpSink::Send(const Datagram& datagram) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(datagram.port));
  address.sin_addr.s_addr = address_;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the socket interface asks for it.
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (sendto(socket_, datagram.payload.data(), datagram.payload.size(), 0, generic, sizeof(address)) < 0) ++num_refused_;
}

}  // namespace lookout::sim
