// Recordings of sentences as CSV: a time and a message each row. OpenCPN's voyage data recorder (VDR) writes "timestamp,type,id,message"; its
// specification of the form (vdr_pi, log_format.adoc) names "timestamp,protocol,msg_type,source,raw_data", columns in any order, others beside them
// and notes that begin with #.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"

namespace lookout::navigator {

/// Which columns count, from 0.
struct CsvColumns {
  std::size_t time = 0;
  std::optional<std::size_t> message;  // nullopt: the first column that begins as a sentence does
};

/// @return the columns when the line is the head of such a recording, or a row of one that has none: a time, and a field that begins as a sentence
std::optional<CsvColumns> FindCsvColumns(std::string_view line);

struct CsvRow {
  std::optional<Utime> time;  // nullopt: the row has no readable time
  std::string message;        // empty: the row ends before the message's column
  bool is_sentence = false;   // begins as a sentence of NMEA 0183 or a tag block does; else the message is of another protocol
};

/// Fields may stand in double quotes, with quotes doubled in them (RFC 4180). A sentence without quotes, whose commas are none of the table, reaches
/// to its checksum, or to the end of the row.
CsvRow ReadCsvRow(std::string_view line, const CsvColumns& columns);

/// @param text  "2026-08-29T10:00:00.123Z"; also with a blank for the T, without a fraction, with an offset ("+02:00", "+0200"), and with neither Z
///              nor offset: UTC
std::optional<Utime> ParseIsoTime(std::string_view text);

}  // namespace lookout::navigator
