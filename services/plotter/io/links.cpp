#include "services/plotter/io/links.hpp"

#include "services/plotter/io/port.hpp"
#include "services/plotter/io/ports.hpp"

namespace lookout::plotter {

namespace {

// Input that comes faster than it can be used must not keep the process here.
constexpr int kMaxHandlersAtOnce = 256;

}  // namespace

void Loop::Poll() {
  context_.restart();
  for (int i = 0; i < kMaxHandlersAtOnce && context_.poll_one() > 0; ++i) {
  }
  const auto now = std::chrono::steady_clock::now();
  for (Port* port : ports_) port->Tick(now);
}

Links::Links() : loop_(std::make_shared<Loop>()) {}
Links::~Links() = default;

std::unique_ptr<Link> Links::Udp(const UdpOptions& options) { return MakeUdpPort(loop_, options); }
std::unique_ptr<Link> Links::TcpServer(const TcpServerOptions& options) { return MakeTcpServerPort(loop_, options); }
std::unique_ptr<Link> Links::TcpClient(const TcpClientOptions& options) { return MakeTcpClientPort(loop_, options); }
std::unique_ptr<Link> Links::Serial(const SerialOptions& options) { return MakeSerialPort(loop_, options); }
std::unique_ptr<Link> Links::Can(const CanOptions& options) { return MakeCanPort(loop_, options); }
std::unique_ptr<Link> Links::WebSocket(const WebSocketOptions& options) { return MakeWebSocketPort(loop_, options); }

void Links::Poll() { loop_->Poll(); }

}  // namespace lookout::plotter
