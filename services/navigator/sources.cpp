#include "services/navigator/sources.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/io/udp_receiver.hpp"
#include "services/navigator/io/gpsd_client.hpp"
#include "services/navigator/io/serial_port.hpp"
#include "services/navigator/io/tcp_client.hpp"

namespace lookout::navigator {

namespace {

// Seconds of sentences at 115200 baud; more can only be a flood.
constexpr int kReceiveBufferBytes = 256 * 1024;

class UdpSource final : public Source {
 public:
  explicit UdpSource(const Connection& connection)
      : drops_name_(connection.name + "_kernel_drops"),
        receiver_({.bind_address = connection.address, .port = connection.port, .receive_buffer_bytes = kReceiveBufferBytes}) {}

  int file_descriptor() const override { return receiver_.file_descriptor(); }
  void Poll(Utime) override {}
  std::optional<Piece> Receive(Utime) override {
    const auto datagram = receiver_.Receive();
    if (!datagram) return std::nullopt;
    return Piece{datagram->host_time, datagram->payload, true};
  }
  std::vector<Counter> counters() override { return {{drops_name_, receiver_.num_kernel_drops()}}; }

 private:
  std::string drops_name_;
  io::UdpReceiver receiver_;
};

}  // namespace

std::unique_ptr<Source> OpenSource(const Connection& connection) {
  switch (connection.kind) {
    case Connection::Kind::kSerial:
      return std::make_unique<SerialPort>(connection.name, connection.file, connection.baud);
    case Connection::Kind::kTcp:
      return std::make_unique<TcpClient>(connection.name, connection.address, connection.port);
    case Connection::Kind::kGpsd:
      return std::make_unique<GpsdClient>(connection.name, connection.address, connection.port);
    case Connection::Kind::kTextLog:
      throw std::logic_error("a text log is no source of now");
    case Connection::Kind::kUdp:
      break;
  }
  return std::make_unique<UdpSource>(connection);
}

}  // namespace lookout::navigator
