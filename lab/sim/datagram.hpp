// A datagram on the boat's network, and its time.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::sim {

struct Datagram {
  Utime time;    // when the datagram reaches the host
  int port = 0;  // UDP destination
  std::vector<std::uint8_t> payload;
};

}  // namespace lookout::sim
