#include "common/io/serial_device.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace lookout::io {

namespace {

constexpr std::array<std::pair<int, speed_t>, 14> kSpeeds{{{1200, B1200},
                                                           {2400, B2400},
                                                           {4800, B4800},
                                                           {9600, B9600},
                                                           {19200, B19200},
                                                           {38400, B38400},
                                                           {57600, B57600},
                                                           {115200, B115200},
                                                           {230400, B230400},
                                                           {460800, B460800},
                                                           {921600, B921600},
                                                           {1000000, B1000000},
                                                           {2000000, B2000000},
                                                           {4000000, B4000000}}};

// @return the fault; empty = none
std::string MakeRaw(int descriptor, int baud) {
  const auto speed = std::ranges::find(kSpeeds, baud, &std::pair<int, speed_t>::first);
  if (speed == kSpeeds.end()) return std::to_string(baud) + " baud is none that serial ports have";
  termios settings{};
  if (tcgetattr(descriptor, &settings) < 0) return std::string("is no serial port (") + std::strerror(errno) + ")";
  cfmakeraw(&settings);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB | CRTSCTS);
  settings.c_cflag |= CS8 | CREAD | CLOCAL;
  settings.c_iflag &= ~static_cast<tcflag_t>(IXOFF | IXANY);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  if (cfsetispeed(&settings, speed->second) < 0 || cfsetospeed(&settings, speed->second) < 0 || tcsetattr(descriptor, TCSANOW, &settings) < 0) {
    return std::string("refuses its settings (") + std::strerror(errno) + ")";
  }
  // tcsetattr is content when it could set anything at all.
  termios in_force{};
  if (tcgetattr(descriptor, &in_force) < 0 || cfgetispeed(&in_force) != speed->second) return "does not take " + std::to_string(baud) + " baud";
  return {};
}

}  // namespace

int OpenSerialDevice(const std::string& device, int baud, int access, std::string& fault) {
  const int descriptor = open(device.c_str(), access | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    fault = std::strerror(errno);
    if (errno == EACCES) fault += " (is this user in the group dialout?)";
    return -1;
  }
  fault = MakeRaw(descriptor, baud);
  // Two readers would take the bytes from each other, two writers would mix theirs.
  if (fault.empty() && ioctl(descriptor, TIOCEXCL) < 0) fault = std::string("cannot be had alone (") + std::strerror(errno) + ")";
  if (fault.empty()) {
    tcflush(descriptor, TCIOFLUSH);
    return descriptor;
  }
  close(descriptor);
  return -1;
}

}  // namespace lookout::io
