// UDP datagrams of one port, with the time at which the kernel took each.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/utime.hpp"
#include "common/io/network.hpp"
#include "common/io/source.hpp"

namespace lookout::io {

struct UdpOptions {
  std::string name = {};         // of its counters
  std::string bind_address;      // numeric IPv4 or IPv6 address of this computer; "0.0.0.0" = every interface
  int port = 0;                  // 0 = one that is free
  int receive_buffer_bytes = 0;  // asked of the kernel, which may grant less: see receive_buffer_bytes()
  // "eth0": datagrams of this interface alone, and it joins the group; empty = any, or the one that bind_address names ("fe80::1%eth0").
  std::string interface = {};
  // Numeric; empty = none. Of the same family as bind_address, which must be "0.0.0.0", "::" or the group itself: a socket that is bound
  // to another address gets no multicast.
  std::string multicast_group = {};
  std::vector<std::string> allowed_source_addresses = {};  // numeric; empty = all
};

class UdpReceiver : public Source {
 public:
  /// Binds for this process alone: a second program on the same port is an error at start, not a silent share of the datagrams.
  ///
  /// @throws std::runtime_error with address, port, interface, reason and, where it is known, what helps
  explicit UdpReceiver(UdpOptions options);
  ~UdpReceiver() override;

  int file_descriptor() const override { return file_descriptor_; }

  /// An interface that went away and came back (a USB adapter) is another one to the kernel: a socket that is bound to it would stay deaf. Looks once
  /// a second, and opens the socket again as soon as it can.
  std::string Poll(Utime now) override;

  /// The oldest datagram from an allowed source. Never throws.
  std::optional<Piece> Receive(Utime now) override;

  /// So that a flood from elsewhere does not hold the caller.
  static constexpr int kMaxRefusedPerCall = 64;

  bool is_empty() const override { return is_empty_; }
  Utime last_time() const override { return last_time_; }
  std::string fault() const override { return fault_; }

  /// NAME_kernel_drops.
  std::vector<Counter> counters() override { return {{drops_name_, num_kernel_drops()}}; }

  /// The real port, also when 0 was asked for.
  int port() const { return port_; }

  /// Bytes granted by the kernel for waiting datagrams.
  int receive_buffer_bytes() const { return receive_buffer_bytes_; }

  /// Datagrams that the kernel dropped because the buffer was full. Asks the kernel.
  std::int64_t num_kernel_drops();

  /// Datagrams whose source is not allowed.
  std::int64_t num_source_refused() const { return num_source_refused_; }

  /// Times that the socket was opened again by Poll().
  std::int64_t num_reopened() const { return num_reopened_; }

 private:
  std::optional<Piece> ReceiveAny();
  std::string CheckInterface();
  std::string Reopen(unsigned int index);

  UdpOptions options_;
  std::string drops_name_;
  std::vector<IpAddress> allowed_sources_;
  int file_descriptor_ = -1;
  unsigned int interface_index_ = 0;  // 0 = of none
  InterfaceTimer timer_;
  std::string fault_;
  bool is_empty_ = true;
  Utime last_time_{};
  int port_ = 0;
  int receive_buffer_bytes_ = 0;
  std::int64_t num_kernel_drops_ = 0;
  std::int64_t num_source_refused_ = 0;
  std::int64_t num_reopened_ = 0;
  std::uint32_t last_drop_count_ = 0;  // the kernel's, which wraps
  sockaddr_storage source_{};          // of the last datagram
  std::vector<std::uint8_t> buffer_;
};

}  // namespace lookout::io
