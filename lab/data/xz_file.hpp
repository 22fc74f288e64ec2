// Files compressed by xz, bit by bit, so that a small file that unpacks to a huge one takes no memory.
#pragma once

#include <lzma.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace lookout::data {

/// Bytes of a .xz file, unpacked as they are asked for.
class XzFile {
 public:
  /// @param max_bytes  more than these, unpacked, are refused
  /// @throws std::runtime_error "file: reason" when it cannot be opened
  XzFile(const std::filesystem::path& file, std::uint64_t max_bytes);
  ~XzFile();
  XzFile(const XzFile&) = delete;
  XzFile& operator=(const XzFile&) = delete;

  /// Fills `out` from its begin. @return how many bytes; fewer than there is place for only at the end
  /// @throws std::runtime_error "reason", without the name of the file, when it is cut off, damaged, no .xz file or unpacks to too much
  std::size_t Read(std::span<std::uint8_t> out);

 private:
  std::ifstream in_;
  lzma_stream stream_ = LZMA_STREAM_INIT;
  bool is_at_end_ = false;
  std::vector<std::uint8_t> packed_;
  std::uint64_t num_left_;
};

}  // namespace lookout::data
