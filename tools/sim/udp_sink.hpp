// Datagrams on the network.
#pragma once

#include <string>

#include "tools/sim/datagram.hpp"

namespace lookout::sim {

class UdpSink final : public Sink {
 public:
  /// @param host  name or IPv4 address, also a broadcast address
  /// @throws std::runtime_error when it is not known, or there is no socket
  explicit UdpSink(const std::string& host);
  ~UdpSink() override;

  /// A datagram that the network does not take is counted: a sensor does not wait for its listener either.
  void Send(const Datagram& datagram) override;

  std::int64_t num_refused() const { return num_refused_; }

 private:
  int socket_ = -1;
  std::uint32_t address_ = 0;  // network byte order
  std::int64_t num_refused_ = 0;
};

}  // namespace lookout::sim
