// A serial port: 8 data bits, no parity, one stop bit, no flow control, raw.
#pragma once

#include <filesystem>
#include <string>

#include "services/navigator/io/stream_source.hpp"

namespace lookout::navigator {

class SerialPort final : public StreamSource {
 public:
  /// @param baud  one that termios has a name for
  SerialPort(const std::string& name, const std::filesystem::path& device, int baud);
  ~SerialPort() override { CloseNow(); }

 private:
  int Open(std::string& fault) override;

  std::string device_;
  int baud_;
};

}  // namespace lookout::navigator
