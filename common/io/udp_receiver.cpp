#include "common/io/udp_receiver.hpp"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <memory>
#include <stdexcept>

namespace lookout::io {

namespace {

constexpr std::size_t kMaxDatagramBytes = 65536;  // of UDP, rounded up

using AddressList = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

AddressList Resolve(const std::string& bind_address, int port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int fault = getaddrinfo(bind_address.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (fault != 0) throw std::runtime_error("cannot listen on '" + bind_address + "' port " + std::to_string(port) + ": " + gai_strerror(fault));
  return {found, &freeaddrinfo};
}

std::string Text(const sockaddr_storage& address, socklen_t size, char* host, std::size_t host_size, char* service, std::size_t service_size) {
  if (getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host, static_cast<socklen_t>(host_size), service,
                  static_cast<socklen_t>(service_size), NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return "";
  }
  return host != nullptr ? host : service;
}

Utime ToUtime(const timespec& time) { return Utime(std::chrono::seconds(time.tv_sec) + std::chrono::microseconds(time.tv_nsec / 1000)); }

}  // namespace

UdpReceiver::UdpReceiver(const std::string& bind_address, int port, int receive_buffer_bytes) : buffer_(kMaxDatagramBytes) {
  const auto address = Resolve(bind_address, port);
  const auto fail = [&](const char* what) {
    const std::string reason = std::strerror(errno);
    if (file_descriptor_ >= 0) close(file_descriptor_);
    throw std::runtime_error("cannot listen on '" + bind_address + "' port " + std::to_string(port) + ": " + what + ": " + reason);
  };
  file_descriptor_ = socket(address->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (file_descriptor_ < 0) fail("socket");
  // FORCE goes over the system's limit and needs the right to; without it the kernel grants what it may.
  if (setsockopt(file_descriptor_, SOL_SOCKET, SO_RCVBUFFORCE, &receive_buffer_bytes, sizeof receive_buffer_bytes) != 0 &&
      setsockopt(file_descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes) != 0) {
    fail("receive buffer");
  }
  const int on = 1;
  if (setsockopt(file_descriptor_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0) fail("kernel time stamps");
  if (setsockopt(file_descriptor_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0) fail("drop counter");
  if (bind(file_descriptor_, address->ai_addr, address->ai_addrlen) != 0) fail("bind");

  int granted_bytes = 0;
  socklen_t size = sizeof granted_bytes;
  // The kernel doubles what it grants, for its own bookkeeping (socket(7)).
  if (getsockopt(file_descriptor_, SOL_SOCKET, SO_RCVBUF, &granted_bytes, &size) == 0) receive_buffer_bytes_ = granted_bytes / 2;
  sockaddr_storage bound{};
  size = sizeof bound;
  std::array<char, NI_MAXSERV> service{};
  if (getsockname(file_descriptor_, reinterpret_cast<sockaddr*>(&bound), &size) != 0) fail("getsockname");
  port_ = std::stoi("0" + Text(bound, size, nullptr, 0, service.data(), service.size()));
}

UdpReceiver::~UdpReceiver() { close(file_descriptor_); }

std::optional<ReceivedDatagram> UdpReceiver::Receive() {
  sockaddr_storage source{};
  iovec part{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<char, 256> control{};
  msghdr message{};
  ssize_t num_bytes = -1;
  do {
    message.msg_name = &source;
    message.msg_namelen = sizeof source;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    num_bytes = recvmsg(file_descriptor_, &message, MSG_DONTWAIT);
  } while (num_bytes < 0 && errno == EINTR);
  if (num_bytes < 0) return std::nullopt;

  ReceivedDatagram datagram;
  datagram.port = port_;
  datagram.payload.assign(buffer_.begin(), buffer_.begin() + num_bytes);
  std::array<char, NI_MAXHOST> host{};
  datagram.source_address = Text(source, message.msg_namelen, host.data(), host.size(), nullptr, 0);
  bool has_time = false;
  for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item)) {
    if (item->cmsg_level != SOL_SOCKET) continue;
    if (item->cmsg_type == SCM_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(item), sizeof time);
      datagram.host_time = ToUtime(time);
      has_time = true;
    } else if (item->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t count = 0;
      std::memcpy(&count, CMSG_DATA(item), sizeof count);
      num_kernel_drops_ += static_cast<std::uint32_t>(count - last_drop_count_);
      last_drop_count_ = count;
    }
  }
  if (!has_time) {
    timespec time{};
    clock_gettime(CLOCK_REALTIME, &time);
    datagram.host_time = ToUtime(time);
  }
  return datagram;
}

}  // namespace lookout::io
