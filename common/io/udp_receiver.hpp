// UDP datagrams of one port, with the time at which the kernel took each.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::io {

struct ReceivedDatagram {
  Utime host_time;             // kernel stamp of the arrival
  int port = 0;                // the port it was sent to
  std::string source_address;  // numeric
  std::vector<std::uint8_t> payload;
};

class UdpReceiver {
 public:
  /// Binds for this process alone: a second program on the same port is an error at start, not a silent share of the datagrams.
  ///
  /// @param bind_address  numeric IPv4 or IPv6 address of this computer; "0.0.0.0" = every interface
  /// @param port          0 = one that is free
  /// @param receive_buffer_bytes  asked of the kernel, which may grant less: see receive_buffer_bytes()
  /// @throws std::runtime_error with address, port and reason
  UdpReceiver(const std::string& bind_address, int port, int receive_buffer_bytes);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Readable while a datagram waits.
  int file_descriptor() const { return file_descriptor_; }

  /// @return the oldest datagram that waits; nullopt when none does. Never waits, never throws.
  std::optional<ReceivedDatagram> Receive();

  /// The real port, also when 0 was asked for.
  int port() const { return port_; }

  /// Bytes granted by the kernel for waiting datagrams.
  int receive_buffer_bytes() const { return receive_buffer_bytes_; }

  /// Datagrams that the kernel dropped because the buffer was full, as far as it has told: it tells with the next datagram.
  std::int64_t num_kernel_drops() const { return num_kernel_drops_; }

 private:
  int file_descriptor_ = -1;
  int port_ = 0;
  int receive_buffer_bytes_ = 0;
  std::int64_t num_kernel_drops_ = 0;
  std::uint32_t last_drop_count_ = 0;  // the kernel's, which wraps
  std::vector<std::uint8_t> buffer_;
};

}  // namespace lookout::io
