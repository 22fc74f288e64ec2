// Compressed pieces of a recording: chunks of bags and MCAP files, messages of a database.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::importer {

enum class Packing { kNone, kBzip2, kLz4, kZstd };

/// Largest piece that is unpacked. Writers make chunks of about 1 MB, and one larger where a single message is.
inline constexpr std::size_t kMaxPieceBytes = std::size_t{64} << 20;

struct Unpacked {
  std::vector<std::uint8_t> bytes;  // as far as could be unpacked
  std::string fault;                // empty: all bytes were unpacked
};

/// @param packed   a frame of LZ4 or of Zstandard, or a stream of bzip2; of kNone the bytes themselves
/// @param num_said the size that the recording states: more bytes are never made, and fewer are a fault. Memory grows with the unpacked bytes, not
///         with this number
Unpacked Unpack(Packing packing, Bytes packed, std::uint64_t num_said);

/// Whether the bytes begin as a frame of Zstandard does.
bool BeginsAsZstd(Bytes bytes);

/// A frame of Zstandard whose size nobody states. @return as Unpack, at most kMaxPieceBytes
Unpacked UnpackZstd(Bytes packed);

}  // namespace lookout::importer
