// Lines of NMEA 0183 out of datagrams and streams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::navigator {

/// NMEA 0183 allows 82 characters with $ and CR LF; receivers with long coordinates send up to some 130.
inline constexpr std::size_t kMaxLineCharacters = 256;

/// The lines of a datagram that may enter NAV_RAW, and how many may not.
struct DatagramLines {
  std::vector<std::string> lines;      // each from $ or ! to its end, without CR LF; right sentences or not
  std::int64_t num_no_start = 0;       // no $ or ! in the line
  std::int64_t num_too_long = 0;       // more than kMaxLineCharacters
  std::int64_t num_not_printable = 0;  // bytes outside of 0x20 to 0x7E
};

/// Cuts at CR and LF, and drops what stands before the first $ or ! of a line: tag blocks (\...\) and junk. Where what is left has no right checksum,
/// but a sentence that has one stands at the end of the line, that is used.
DatagramLines SplitDatagram(Bytes payload);

/// @return whether `line` may stand in NAV_RAW: begins with $ or !, printable ASCII, at most kMaxLineCharacters
bool IsLine(std::string_view line);

/// @return whether `name` may stand in NAV_RAW for a source: 1 to 32 of a to z and 0 to 9
bool IsSourceName(std::string_view name);

/// Cuts the bytes of a stream, which come in pieces of any size, into whole lines.
class LineAssembler {
 public:
  /// @return the lines that are whole now; what is not stays for the next call. A line that does not end within kMaxLineCharacters several times
  ///         over (another protocol, a wrong baud rate) is dropped and counted as too long.
  DatagramLines Add(Bytes bytes);

  /// The connection broke: what is held will not be completed.
  void Clear() { rest_.clear(); }

 private:
  std::string rest_;
};

}  // namespace lookout::navigator
