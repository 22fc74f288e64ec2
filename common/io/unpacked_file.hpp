// The bytes of a file from its beginning on; those of a file packed by gzip as they were before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

struct gzFile_s;

namespace lookout::io {

/// Reads forward only, with a buffer of 256 kB, however large the file is and however much comes out of it.
class UnpackedFile {
 public:
  /// @throws std::runtime_error naming the file when it is no regular file (nothing else is opened: a pipe would hold the caller) or cannot be opened
  explicit UnpackedFile(const std::filesystem::path& file);

  /// @return how many bytes were read: fewer than `out` holds at the end and where the file is damaged
  std::size_t Read(std::span<std::uint8_t> out);

  /// Why reading ended before the end: the packed file is cut or damaged, or the disk cannot be read. Empty: it did not.
  const std::string& fault() const { return fault_; }

  /// Bytes of the file that were read, as it lies there.
  std::int64_t position_bytes() const;

 private:
  std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> file_;
  std::string fault_;
};

}  // namespace lookout::io
