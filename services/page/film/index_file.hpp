// The index of a log as a file beside it: NAME.lcmlog.index.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "services/page/film/log_part.hpp"

namespace lookout::page {

/// Size, time and digest, by which an index recognises its log.
struct LogIdentity {
  std::int64_t size_bytes = 0;
  std::int64_t modified_ns = 0;  // since 1970 UTC
  std::string digest;            // SHA-256 of the log's first and last 64 KiB, hexadecimal

  bool operator==(const LogIdentity&) const = default;
};

/// @throws std::runtime_error when the log cannot be read
LogIdentity IdentityOf(const std::filesystem::path& log);

std::filesystem::path IndexFileOf(const std::filesystem::path& log);

/// Little-endian; equal logs give equal bytes. Its last 64 bytes are the SHA-256 of all before.
std::vector<std::uint8_t> ToIndexBytes(const LogIdentity& identity, const LogPart& part);

/// @return nullopt when the bytes are no index, or torn, or another log's, or of another version, or name places that the log cannot have
std::optional<LogPart> FromIndexBytes(Bytes bytes, const LogIdentity& identity);

/// Reads the index beside the log; where there is none that fits, reads the log and writes one.
///
/// @param on_progress  bytes of the log that were read, for each 8 MB; false: ends
/// @param tell         a line where the index cannot be written: it is kept in memory then
/// @return nullopt when on_progress ended it
/// @throws std::runtime_error when the log cannot be read
std::optional<LogPart> LoadIndex(const std::filesystem::path& log, bool writes_index, const std::function<bool(std::int64_t)>& on_progress,
                                 const std::function<void(const std::string&)>& tell);

}  // namespace lookout::page
