// Packets out of a pcapng file, whose interfaces may be of several link types: libpcap refuses such a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "common/io/unpacked_file.hpp"

namespace lookout::lidar {

/// A frame as it was captured.
struct CapturedFrame {
  int link_type = 0;          // DLT number as libpcap has it on this computer
  Bytes bytes;                // until the next call
  bool is_cut = false;        // the frame was longer on the wire
  std::optional<Utime> time;  // nullopt: an impossible stamp; a packet block without a stamp has time 0, as in libpcap
};

/// Blocks as draft-ietf-opsawg-pcapng has them: sections in either byte order, one behind the other; interfaces with their own snap length,
/// resolution and offset of stamps; enhanced, simple and old packet blocks. All other blocks are passed over. At most 16 MB are held, the largest
/// block.
class PcapngReader {
 public:
  /// @param file  may be packed by gzip
  /// @throws std::runtime_error as io::UnpackedFile
  explicit PcapngReader(const std::filesystem::path& file) : file_(file) {}

  /// @return the next frame, in the order of the file; nullopt at the end. Where the file is damaged reading ends: see damage().
  std::optional<CapturedFrame> Next();

  /// Link types of the interfaces that were described so far, each once, as they came.
  const std::vector<int>& link_types() const { return link_types_; }

  const std::string& damage() const { return damage_; }  // empty = none
  std::int64_t position_bytes() const { return file_.position_bytes(); }

 private:
  struct Interface {
    int link_type = 0;
    std::uint32_t snap_length_bytes = 0;  // 0 = without bound
    bool is_binary = false;               // stamps count 2^-exponent s, else 10^-exponent s
    unsigned int exponent = 6;
    std::int64_t offset_s = 0;
  };

  bool ReadBlock();
  bool ReadHeader(std::vector<std::uint8_t>& header);
  bool Fail(const std::string& reason);
  std::uint32_t U32(std::size_t offset) const;
  std::uint16_t U16(std::size_t offset) const;
  bool BeginSection();
  bool AddInterface();
  std::optional<CapturedFrame> FrameOf(std::uint32_t interface, std::optional<std::uint64_t> stamp, std::size_t header_bytes,
                                       std::uint32_t captured_bytes, std::uint32_t wire_bytes);
  std::optional<CapturedFrame> PacketOfBlock();

  io::UnpackedFile file_;
  std::vector<Interface> interfaces_;  // of this section
  std::vector<int> link_types_;
  bool is_big_endian_ = false;
  bool has_section_ = false;
  std::uint32_t block_type_ = 0;
  std::vector<std::uint8_t> body_;  // of the block, without its type and its two lengths
  std::string damage_;
};

}  // namespace lookout::lidar
