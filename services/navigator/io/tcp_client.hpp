// A client of a TCP server that sends sentences.
#pragma once

#include <string>

#include "services/navigator/io/stream_source.hpp"

namespace lookout::navigator {

class TcpClient : public StreamSource {
 public:
  /// @param address  numeric
  TcpClient(const std::string& name, const std::string& address, int port, const std::string& kind = "TCP server");
  ~TcpClient() override { CloseNow(); }

 protected:
  int Open(std::string& fault) override;
  bool IsConnecting() const override { return true; }

  std::string address_;
  std::string port_;
};

}  // namespace lookout::navigator
