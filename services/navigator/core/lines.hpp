// Lines of NMEA 0183 out of datagrams and streams.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::navigator {

/// NMEA 0183 allows 82 characters with $ and CR LF; receivers with long coordinates send up to some 130.
inline constexpr std::size_t kMaxLineCharacters = 256;

/// The lines of a datagram that may enter NAV_RAW, and how many may not.
struct DatagramLines {
  std::vector<std::string> lines;      // each from $ or ! to its end, without CR LF; right sentences or not
  std::int64_t num_no_start = 0;       // no $ or ! in the line
  std::int64_t num_too_long = 0;       // more than kMaxLineCharacters
  std::int64_t num_not_printable = 0;  // bytes outside of 0x20 to 0x7E
  std::int64_t num_cut_off = 0;        // begins of sentences without a right checksum that another sentence follows on the same line
};

/// Cuts at CR and LF, and drops text before the first $ or ! of a line (tag blocks (\...\) and junk) and blanks at its end. Where the rest is no
/// sentence with a right checksum, but holds such sentences (without an end of line between them, behind a false start, or before junk), each
/// sentence becomes a line.
DatagramLines SplitDatagram(Bytes payload);

/// @return whether `line` is $ or !, talker and type, and a comma, whatever stands behind it
bool BeginsAsSentence(std::string_view line);

/// @return whether `text` ends in * and two hexadecimal digits, so that a $ or ! behind it begins another sentence
bool EndsInChecksum(std::string_view text);

/// @return whether `line` may stand in NAV_RAW: begins with $ or !, printable ASCII, at most kMaxLineCharacters
bool IsLine(std::string_view line);

/// @return whether `name` may stand in NAV_RAW for a source: 1 to 32 of a to z and 0 to 9
bool IsSourceName(std::string_view name);

/// @return whether `name` may stand in NAV_RAW for what lookout-import took out of a recording of others: "imported:" and the topic, 64 characters at
///         most, printable ASCII without blanks. No input in config has such a name.
bool IsImportedSource(std::string_view name);
inline constexpr std::string_view kImportedSource = "imported:";
inline constexpr std::size_t kMaxImportedSourceCharacters = 64;

/// Puts lines together that their senders cut over several datagrams, as gateways from serial lines do. The end of a datagram is held back while it
/// may go on: it begins as a line, and has neither an end of line nor a checksum. A sentence without a checksum looks like that, too: where sentences
/// without a checksum count, the end is returned at once, except for a datagram that goes on with a line itself, and once more as a part of the
/// complete line if it does go on.
class DatagramJoiner {
 public:
  /// The rest of a line may take this long: a gateway that sends only full datagrams keeps it until the next second of a receiver.
  static constexpr std::chrono::seconds kMaxWait{2};
  /// Most senders of which text is held back at once.
  static constexpr std::size_t kMaxSenders = 64;

  /// @param sender  address and port: lines of two senders are never joined
  /// @return the lines that are complete now. Begins of lines that did not go on in time are returned as well, so that they are recorded and counted.
  DatagramLines Add(Utime arrival, Bytes payload, const std::string& sender, bool requires_checksum);

  /// @return begins of lines that did not go on until now
  DatagramLines AdvanceTo(Utime now);

  /// @return all that is held back
  DatagramLines Finish();

  bool is_empty() const { return held_.empty(); }

 private:
  struct Held {
    std::string text;
    Utime arrival;
    bool is_given = false;  // returned as it stood, as it may be a whole sentence without a checksum
  };
  static void GiveUp(const Held& held, std::string& text);
  void MakeRoom(std::string& text);

  std::map<std::string, Held> held_;  // by sender
};

/// Cuts the bytes of a stream, which come in pieces of any size, into whole lines.
class LineAssembler {
 public:
  /// @return the lines that are complete now; the rest stays for the next call. A $ or ! behind a checksum ends a line, too. A line that does not end
  /// within kMaxLineCharacters several times over (another protocol, a wrong baud rate) is dropped and counted as too long.
  DatagramLines Add(Bytes bytes);

  /// The connection broke: the held text will not be completed.
  void Clear() { rest_.clear(); }

 private:
  std::string rest_;
};

}  // namespace lookout::navigator
