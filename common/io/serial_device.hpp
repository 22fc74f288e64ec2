// A serial port as a device of this computer: 8 data bits, no parity, one stop bit, no flow control, raw.
#pragma once

#include <string>

namespace lookout::io {

/// Opens it for this process alone. Waiting bytes, in either direction, are dropped, as they are of unknown age.
///
/// @param device  "/dev/serial/by-id/..."
/// @param baud    one that termios has a name for
/// @param access  O_RDONLY or O_RDWR
/// @return a descriptor that does not block; -1 with `fault`
int OpenSerialDevice(const std::string& device, int baud, int access, std::string& fault);

}  // namespace lookout::io
