// The server's interface to recordings: logs, or the last minutes of a live bus. Its calls may take time (they read a disk) and are made on a thread
// of their own, one at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/utime.hpp"
#include "services/page/core/request.hpp"

namespace lookout::page {

/// A message out of a recording.
struct RecordedMessage {
  ChannelIndex channel = 0;
  Utime time;  // of its event
  std::vector<std::uint8_t> bytes;
};

/// The messages of a moment or a span. When `refusal` is not empty there are none.
struct Answer {
  std::string refusal;
  Utime time;
  Utime scan_time;
  std::int64_t scan_index = -1;  // -1: no scan
  std::int64_t num_scans = 0;
  std::vector<RecordedMessage> messages;
};

class Recordings {
 public:
  virtual ~Recordings() = default;

  /// JSON text of the array `sources` (PROTOCOL.md). Cheap.
  virtual std::string SourcesText() = 0;

  virtual Answer Find(const At& request) = 0;
  virtual Answer Find(const Range& request) = 0;

  /// JSON text of a `strip`, or of a `refused`.
  virtual std::string Strip(const StripRequest& request) = 0;
};

}  // namespace lookout::page
