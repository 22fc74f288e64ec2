// The kind of a file, by its type on the disk and its first bytes, so that each program can say it and name the command that helps.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/core/bytes.hpp"

namespace lookout::io {

enum class FileKind {
  kMissing,
  kUnreadable,  // the right to read it is missing, or the disk fails
  kFolder,
  kPipe,
  kSocket,
  kDevice,
  kEmpty,
  kPcap,
  kPcapng,
  kLcmLog,  // begins with an event; one that is damaged at its beginning is kUnknown
  kGzip,
  kXz,
  kZstd,
  kBzip2,
  kZip,
  kLz4,
  kRosBag,
  kMcap,
  kSqlite,
  kUtf16,  // text
  kNmea,   // text with a line that begins as a sentence of NMEA 0183 does
  kText,
  kUnknown,
};

/// Never waits: only a regular file is opened.
FileKind FileKindOf(const std::filesystem::path& file);

/// @param head  the first bytes of a regular file, 4096 of them where it has so many
FileKind FileKindOfHead(Bytes head);

/// The kind of the content of a gzip file, by its first bytes; kUnknown where nothing comes out.
FileKind PackedKindOf(const std::filesystem::path& file);

/// "a capture (pcap)"
std::string_view InWords(FileKind kind);

/// The kind of file that a program wants to read.
enum class Wanted {
  kLog,        // an lcm-log
  kCapture,    // pcap or pcapng, also packed by gzip
  kTextLog,    // of NMEA 0183
  kImport,     // what lookout-import reads: JSON, ROS bags, rosbag2, MCAP
  kRecording,  // any of these, or a text log
};

/// Why a file cannot be of the wanted kind, and the command that helps: "x.pcap: is a capture (pcap), no lcm-log. A log is made of it by: ..."
///
/// @return empty where it may be of the wanted kind. A log may also be kUnknown or kText (damaged at its beginning), or kEmpty (just begun)
std::string WhyNot(const std::filesystem::path& file, Wanted wanted);

/// The message for a log in which no event was found: it is empty, or other than a log.
std::string NoEventText(const std::filesystem::path& file);

}  // namespace lookout::io
