#include "common/io/udp_receiver.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <utility>

namespace lookout::io {

namespace {

constexpr std::size_t kMaxDatagramBytes = 65536;  // of UDP, rounded up

using AddressList = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

std::string Where(const UdpOptions& options) {
  std::string text = "cannot listen on '" + options.bind_address + "' port " + std::to_string(options.port);
  if (!options.interface.empty()) text += " of interface '" + options.interface + "'";
  return text;
}

AddressList Resolve(const UdpOptions& options) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int fault = getaddrinfo(options.bind_address.c_str(), std::to_string(options.port).c_str(), &hints, &found);
  if (fault != 0) throw std::runtime_error(Where(options) + ": " + gai_strerror(fault));
  return {found, &freeaddrinfo};
}

// The interface in "fe80::1%eth0"; empty when there is none, or it is a number.
std::string ZoneOf(const std::string& address) {
  const auto place = address.find('%');
  const std::string zone = place == std::string::npos ? "" : address.substr(place + 1);
  return zone.find_first_not_of("0123456789") == std::string::npos ? "" : zone;
}

// Advice, where the reason alone does not say it.
std::string Remedy(int reason, const UdpOptions& options) {
  switch (reason) {
    case EADDRINUSE:
      return " (another program listens there: ss -ulpn 'sport = :" + std::to_string(options.port) + "' names it)";
    case EADDRNOTAVAIL:
      return " (no interface has that address now: ip address lists those that there are)";
    case EINVAL:
      return options.interface.empty() && options.bind_address.find(':') != std::string::npos
                 ? " (a link-local address needs its interface: " + options.bind_address + "%eth0, or set interface)"
                 : "";
    case ENODEV:
      return " (a multicast group needs a route or an interface: set interface)";
    case EPERM:
    case EACCES:
      return " (ports below 1024, and on kernels before 5.7 an interface, need a right: AmbientCapabilities=CAP_NET_BIND_SERVICE CAP_NET_RAW)";
    default:
      return "";
  }
}

// A socket that closes itself when the opening fails half way.
class OpenedSocket {
 public:
  OpenedSocket(const UdpOptions& options, int family) : options_(options), descriptor_(socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    Require(descriptor_ >= 0, "socket");
  }
  ~OpenedSocket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  OpenedSocket(const OpenedSocket&) = delete;
  OpenedSocket& operator=(const OpenedSocket&) = delete;

  int descriptor() const { return descriptor_; }
  int Release() { return std::exchange(descriptor_, -1); }

  void Require(bool is_fine, const char* what) const {
    if (is_fine) return;
    const int reason = errno;
    throw std::runtime_error(Where(options_) + ": " + what + ": " + std::strerror(reason) + Remedy(reason, options_));
  }

  template <typename T>
  bool Set(int level, int name, const T& value) const {
    return setsockopt(descriptor_, level, name, &value, sizeof value) == 0;
  }

 private:
  const UdpOptions& options_;
  int descriptor_;
};

void JoinGroup(const OpenedSocket& opened, const UdpOptions& options, int family, unsigned int interface_index) {
  const bool is_ipv4 = family == AF_INET;
  const int level = is_ipv4 ? IPPROTO_IP : IPPROTO_IPV6;
  group_req request{};
  request.gr_interface = interface_index;
  request.gr_group.ss_family = static_cast<sa_family_t>(family);
  void* address = &reinterpret_cast<sockaddr_in6*>(&request.gr_group)->sin6_addr;
  if (is_ipv4) address = &reinterpret_cast<sockaddr_in*>(&request.gr_group)->sin_addr;
  if (inet_pton(family, options.multicast_group.c_str(), address) != 1) {
    throw std::runtime_error(Where(options) + ": the multicast group is no numeric address of the same family");
  }
  // Otherwise the kernel hands on every group that any program of this computer has joined.
  opened.Require(opened.Set(level, is_ipv4 ? IP_MULTICAST_ALL : IPV6_MULTICAST_ALL, 0), "multicast of this group alone");
  opened.Require(opened.Set(level, MCAST_JOIN_GROUP, request), "joining the multicast group");
}

int Open(const UdpOptions& options, unsigned int interface_index) {
  const auto address = Resolve(options);
  OpenedSocket opened(options, address->ai_family);
  const int size = options.receive_buffer_bytes;
  // FORCE goes over the system's limit and needs the right to; without it the kernel grants what it may.
  opened.Require(opened.Set(SOL_SOCKET, SO_RCVBUFFORCE, size) || opened.Set(SOL_SOCKET, SO_RCVBUF, size), "receive buffer");
  opened.Require(opened.Set(SOL_SOCKET, SO_TIMESTAMPNS, 1), "kernel time stamps");
  if (interface_index != 0) {
    const auto& name = options.interface;
    opened.Require(setsockopt(opened.descriptor(), SOL_SOCKET, SO_BINDTODEVICE, name.c_str(), static_cast<socklen_t>(name.size())) == 0,
                   "binding to the interface");
  }
  opened.Require(bind(opened.descriptor(), address->ai_addr, address->ai_addrlen) == 0, "bind");
  if (!options.multicast_group.empty()) JoinGroup(opened, options, address->ai_family, interface_index);
  return opened.Release();
}

int PortOf(int descriptor) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound), &size) != 0) return 0;
  // The port stands at the same place in both.
  return ntohs(reinterpret_cast<const sockaddr_in*>(&bound)->sin_port);
}

// The kernel doubles what it grants, for its own bookkeeping (socket(7)).
int GrantedBytes(int descriptor) {
  int granted_bytes = 0;
  socklen_t size = sizeof granted_bytes;
  return getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &granted_bytes, &size) == 0 ? granted_bytes / 2 : 0;
}

IpAddress AddressOf(const sockaddr_storage& source) {
  IpAddress address;
  if (source.ss_family == AF_INET) {
    constexpr std::size_t kPrefixSize = 12;
    address.bytes[kPrefixSize - 2] = 0xFF;
    address.bytes[kPrefixSize - 1] = 0xFF;
    std::memcpy(address.bytes.data() + kPrefixSize, &reinterpret_cast<const sockaddr_in*>(&source)->sin_addr, sizeof(in_addr));
  } else {
    std::memcpy(address.bytes.data(), &reinterpret_cast<const sockaddr_in6*>(&source)->sin6_addr, sizeof(in6_addr));
  }
  return address;
}

Utime ToUtime(const timespec& time) { return Utime(std::chrono::seconds(time.tv_sec) + std::chrono::microseconds(time.tv_nsec / 1000)); }

}  // namespace

UdpReceiver::UdpReceiver(UdpOptions options)
    : options_(std::move(options)), drops_name_(options_.name + "_kernel_drops"), buffer_(kMaxDatagramBytes) {
  for (const auto& text : options_.allowed_source_addresses) {
    const auto address = ParseIpAddress(text);
    if (!address) throw std::runtime_error(Where(options_) + ": '" + text + "' is no numeric address of a source");
    allowed_sources_.push_back(*address);
  }
  if (options_.interface.empty()) options_.interface = ZoneOf(options_.bind_address);
  if (!options_.interface.empty()) {
    interface_index_ = if_nametoindex(options_.interface.c_str());
    if (interface_index_ == 0) throw std::runtime_error(Where(options_) + ": " + NoInterfaceText(options_.interface));
  }
  file_descriptor_ = Open(options_, interface_index_);
  port_ = PortOf(file_descriptor_);
  receive_buffer_bytes_ = GrantedBytes(file_descriptor_);
}

UdpReceiver::~UdpReceiver() { close(file_descriptor_); }

std::optional<Source::Piece> UdpReceiver::ReceiveAny() {
  iovec part{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<char, 256> control{};
  msghdr message{};
  ssize_t num_bytes = -1;
  do {
    message.msg_name = &source_;
    message.msg_namelen = sizeof source_;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    num_bytes = recvmsg(file_descriptor_, &message, MSG_DONTWAIT);
  } while (num_bytes < 0 && errno == EINTR);
  if (num_bytes < 0) return std::nullopt;

  timespec time{};
  bool has_time = false;
  for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item)) {
    if (item->cmsg_level != SOL_SOCKET || item->cmsg_type != SCM_TIMESTAMPNS) continue;
    std::memcpy(&time, CMSG_DATA(item), sizeof time);
    has_time = true;
  }
  if (!has_time) clock_gettime(CLOCK_REALTIME, &time);
  // The port stands at the same place in both families.
  return Piece{.host_time = ToUtime(time),
               .bytes = Bytes(buffer_.data(), static_cast<std::size_t>(num_bytes)),
               .port = port_,
               .source_port = ntohs(reinterpret_cast<const sockaddr_in*>(&source_)->sin_port)};
}

std::optional<Source::Piece> UdpReceiver::Receive(Utime) {
  for (int i = 0; i < kMaxRefusedPerCall; ++i) {
    auto datagram = ReceiveAny();
    is_empty_ = !datagram;
    if (!datagram) return std::nullopt;
    last_time_ = datagram->host_time;
    const auto source = AddressOf(source_);
    if (allowed_sources_.empty() || std::ranges::find(allowed_sources_, source) != allowed_sources_.end()) {
      datagram->source_address = ToText(source);
      return datagram;
    }
    ++num_source_refused_;
  }
  return std::nullopt;
}

std::int64_t UdpReceiver::num_kernel_drops() {
  // Not by SO_RXQ_OVFL, which tells of drops only with the next datagram that is taken.
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (getsockopt(file_descriptor_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 && size > SK_MEMINFO_DROPS * sizeof memory[0]) {
    const std::uint32_t count = memory[SK_MEMINFO_DROPS];
    num_kernel_drops_ += static_cast<std::uint32_t>(count - last_drop_count_);
    last_drop_count_ = count;
  }
  return num_kernel_drops_;
}

std::string UdpReceiver::Reopen(unsigned int index) {
  try {
    UdpOptions same_port = options_;
    same_port.port = port_;
    const int opened = Open(same_port, index);
    num_kernel_drops();  // the old one's go with it
    // Takes the old one's number, by which the caller knows it.
    const bool is_taken = dup3(opened, file_descriptor_, O_CLOEXEC) >= 0;
    const int reason = errno;
    close(opened);
    if (!is_taken) return Where(same_port) + ": " + std::strerror(reason);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  interface_index_ = index;
  last_drop_count_ = 0;
  receive_buffer_bytes_ = GrantedBytes(file_descriptor_);
  ++num_reopened_;
  return "";
}

std::string UdpReceiver::CheckInterface() {
  const unsigned int index = if_nametoindex(options_.interface.c_str());
  if (index == 0) return "interface '" + options_.interface + "' has gone; waiting for it";
  if (index != interface_index_) {
    const auto fault = Reopen(index);
    if (!fault.empty()) return "interface '" + options_.interface + "' is back, but not ready: " + fault;
  }
  return IsInterfaceUp(options_.interface) ? "" : "interface '" + options_.interface + "' is down";
}

std::string UdpReceiver::Poll(Utime now) {
  if (options_.interface.empty() || !timer_.IsDue(now)) return "";
  const auto num_reopened_before = num_reopened_;
  const auto fault = CheckInterface();
  if (fault == fault_ && num_reopened_ == num_reopened_before) return "";
  fault_ = fault;
  return "port " + std::to_string(port_) + ": " + (fault.empty() ? "interface '" + options_.interface + "' is back" : fault);
}

}  // namespace lookout::io
