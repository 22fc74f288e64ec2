// Reads bytes at any place of a recording: from a file, or from memory in tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::importer {

class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;

  virtual std::uint64_t size() const = 0;

  /// @return how many bytes were read: fewer than `out` holds only at the end, or where the disk fails
  virtual std::size_t Read(std::uint64_t offset, std::span<std::uint8_t> out) const = 0;
};

class FileSource final : public ByteSource {
 public:
  /// @throws std::runtime_error when it cannot be opened
  explicit FileSource(const std::filesystem::path& file);
  ~FileSource() override;

  std::uint64_t size() const override { return size_; }
  std::size_t Read(std::uint64_t offset, std::span<std::uint8_t> out) const override;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {}

  std::uint64_t size() const override { return bytes_.size(); }
  std::size_t Read(std::uint64_t offset, std::span<std::uint8_t> out) const override;

 private:
  std::vector<std::uint8_t> bytes_;
};

/// A stretch of a recording that is looked through for something. It is kept, so that each of many short ways through it does not read it anew.
class SearchWindow {
 public:
  static constexpr std::size_t kStepBytes = std::size_t{1} << 20;

  /// @param most_bytes  longest thing that is looked for
  explicit SearchWindow(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// @return the bytes from `offset` on, to the end of the stretch and further by the longest thing, or to the end of the recording
  Bytes From(const ByteSource& source, std::uint64_t offset);

  /// Where the next stretch begins: what begins before it was in this one as a whole.
  std::uint64_t end() const { return begin_ + kStepBytes; }

 private:
  std::size_t most_bytes_;
  std::uint64_t begin_ = 0;
  std::vector<std::uint8_t> bytes_;
};

/// As many bytes from `offset` on as there are, `count` at most. Memory is taken as they come, so a false count costs no more than the file has.
std::vector<std::uint8_t> ReadBytes(const ByteSource& source, std::uint64_t offset, std::uint64_t count);

}  // namespace lookout::importer
