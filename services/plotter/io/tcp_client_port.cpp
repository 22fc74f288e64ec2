#include "services/plotter/io/ports.hpp"
#include "services/plotter/io/reopening_port.hpp"
#include "services/plotter/io/tcp.hpp"

namespace lookout::plotter {

namespace {

class TcpClientPort final : public ReopeningPort {
 public:
  TcpClientPort(std::shared_ptr<Loop> loop, const TcpClientOptions& options)
      : ReopeningPort(std::move(loop), options.name, "TCP server " + PlaceOf(options.address, options.port), std::chrono::seconds(5)),
        server_(ParseAddress(options.name, options.address), static_cast<std::uint16_t>(options.port)) {}

 private:
  std::shared_ptr<Connection> Open(std::string& fault) override {
    boost::asio::ip::tcp::socket socket(context());
    boost::system::error_code error;
    socket.open(server_.protocol(), error);
    if (error) {
      fault = error.message();
      return nullptr;
    }
    const auto connection = std::make_shared<TcpConnection>(std::move(socket), TcpConnection::Made::kByUs, traffic_);
    connection->Connect(server_);
    return connection;
  }

  boost::asio::ip::tcp::endpoint server_;
};

}  // namespace

std::unique_ptr<Port> MakeTcpClientPort(std::shared_ptr<Loop> loop, const TcpClientOptions& options) {
  return std::make_unique<TcpClientPort>(std::move(loop), options);
}

}  // namespace lookout::plotter
