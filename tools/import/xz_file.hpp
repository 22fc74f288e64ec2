// Files compressed by xz, bit by bit, so that a small file that unpacks to a huge one takes no memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::importer {

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
  struct Decoder;
  std::ifstream in_;
  std::unique_ptr<Decoder> decoder_;
  std::vector<std::uint8_t> packed_;
  std::uint64_t num_left_;
};

/// Plain CSV, compressed by xz: a header line, no quotes. Lines are counted from 1, the header's.
class XzCsv {
 public:
  static constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;
  static constexpr std::size_t kMaxLineBytes = 4096;

  /// @param columns  that must be there, in any order; others are left alone
  /// @throws std::runtime_error "file:line: reason", as all below
  XzCsv(const std::filesystem::path& file, std::span<const std::string_view> columns);

  /// @return whether there is another row; its cells are then at hand
  bool Next();

  /// @param column  index into the columns that were asked for
  std::string_view Text(std::size_t column) const { return cells_[place_[column]]; }

  /// @throws std::runtime_error unless the cell is a whole number within the limits
  std::int64_t WholeNumber(std::size_t column, std::int64_t min, std::int64_t max) const;

  /// @throws std::runtime_error unless the cell is a finite number
  double Number(std::size_t column) const;

  [[noreturn]] void Refuse(const std::string& reason) const;

 private:
  bool ReadLine();
  void Split();

  std::filesystem::path file_;
  XzFile bytes_;
  std::vector<std::uint8_t> block_;
  std::size_t block_begin_ = 0;
  std::size_t block_end_ = 0;
  std::string line_;
  std::vector<std::string_view> cells_;
  std::vector<std::string> names_;  // of the columns that were asked for
  std::vector<std::size_t> place_;  // of these in a row
  std::size_t num_columns_ = 0;
  std::int64_t line_number_ = 0;
};

}  // namespace lookout::importer
