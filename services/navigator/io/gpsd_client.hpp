// gpsd as a source: it is asked for the sentences of its receivers as they are, and libgps carries them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "services/navigator/io/tcp_client.hpp"

namespace lookout::navigator {

class GpsdClient final : public TcpClient {
 public:
  /// @param address  numeric
  GpsdClient(const std::string& name, const std::string& address, int port);
  ~GpsdClient() override;

 private:
  struct Library;

  int OnConnected(int descriptor, std::string& fault) override;
  Result Read(int descriptor, std::vector<std::uint8_t>& bytes) override;
  void Close(int descriptor) override;

  std::unique_ptr<Library> library_;
};

}  // namespace lookout::navigator
