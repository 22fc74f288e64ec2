#include "services/navigator/io/serial_port.hpp"

#include <fcntl.h>

#include "common/io/serial_device.hpp"

namespace lookout::navigator {

SerialPort::SerialPort(const std::string& name, const std::filesystem::path& device, int baud)
    : StreamSource(name, "serial port " + device.string()), device_(device), baud_(baud) {}

int SerialPort::Open(std::string& fault) { return io::OpenSerialDevice(device_, baud_, O_RDONLY, fault); }

}  // namespace lookout::navigator
