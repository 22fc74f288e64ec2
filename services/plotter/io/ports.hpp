// The kinds of ports, each made in the file of its name. Options and errors: links.hpp.
#pragma once

#include <memory>

#include "services/plotter/io/port.hpp"

namespace lookout::plotter {

std::unique_ptr<Port> MakeUdpPort(std::shared_ptr<Loop> loop, const UdpOptions& options);
std::unique_ptr<Port> MakeTcpServerPort(std::shared_ptr<Loop> loop, const TcpServerOptions& options);
std::unique_ptr<Port> MakeTcpClientPort(std::shared_ptr<Loop> loop, const TcpClientOptions& options);
std::unique_ptr<Port> MakeSerialPort(std::shared_ptr<Loop> loop, const SerialOptions& options);
std::unique_ptr<Port> MakeCanPort(std::shared_ptr<Loop> loop, const CanOptions& options);
std::unique_ptr<Port> MakeWebSocketPort(std::shared_ptr<Loop> loop, const WebSocketOptions& options);

}  // namespace lookout::plotter
