// TCP connections, made by us or by a client.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <string>

#include "services/plotter/io/stream_connection.hpp"

namespace lookout::plotter {

/// @throws std::runtime_error that names the output
boost::asio::ip::address ParseAddress(const std::string& name, const std::string& address);

/// "192.168.1.5 port 10110"
std::string PlaceOf(const std::string& address, int port);

/// Little waits in the kernel; a vanished receiver is noticed, also when nothing is sent.
void PrepareSocket(boost::asio::ip::tcp::socket& socket);

/// A client's: it may send no more and still read, and it learns when it is cut off.
class TcpConnection final : public StreamConnection<boost::asio::ip::tcp::socket> {
 public:
  enum class Made { kByUs, kByClient };

  /// @param socket  open
  TcpConnection(boost::asio::ip::tcp::socket socket, Made made, std::shared_ptr<Traffic> traffic);

  void Connect(const boost::asio::ip::tcp::endpoint& endpoint);

 private:
  void OnEnd() override;
  bool IsReachable() override;
  void Check() override;
  void PrepareClose() override;

  Made made_;
  bool is_half_closed_ = false;
};

}  // namespace lookout::plotter
