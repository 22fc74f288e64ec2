// The letters of a text file, however they are stored: packed by gzip, in UTF-16, or as they are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/io/unpacked_file.hpp"

namespace lookout::io {

class TextFile {
 public:
  /// @throws std::runtime_error as UnpackedFile
  explicit TextFile(std::filesystem::path file);

  /// The next byte; a mark of the coding at the start is left out. Of UTF-16, which has such a mark or begins with ASCII letters, each letter
  /// is one byte: 0xFF where it has none in ISO 8859-1.
  ///
  /// @return false at the end
  bool Get(char& letter);

  /// Where the next letter stands, for Seek.
  std::int64_t position() const { return buffer_begin_ + static_cast<std::int64_t>(next_); }

  /// Goes back (or forward) to where position() was once; 0 is the start. Back by more than kKeptBytes reads from there again.
  void Seek(std::int64_t position);
  static constexpr std::size_t kKeptBytes = 256UL * 1024;

  /// One letter back, behind a Get.
  void Back() { next_ -= BytesPerLetter(); }

  /// Why reading ended before the end of the file; empty: it did not.
  const std::string& fault() const { return bytes_.fault(); }

  /// Bytes of the file that were read, as it lies there.
  std::int64_t position_bytes() const { return bytes_.position_bytes(); }

 private:
  enum class Coding { kBytes, kUtf16LittleEndian, kUtf16BigEndian };
  std::size_t BytesPerLetter() const { return coding_ == Coding::kBytes ? 1 : 2; }
  void Begin();
  bool Fill();

  std::filesystem::path file_;
  UnpackedFile bytes_;
  std::vector<std::uint8_t> buffer_;  // the last unpacked bytes
  std::int64_t buffer_begin_ = 0;     // their place in the unpacked text
  std::size_t next_ = 0;              // in the buffer
  Coding coding_ = Coding::kBytes;
  std::int64_t mark_bytes_ = 0;
};

}  // namespace lookout::io
