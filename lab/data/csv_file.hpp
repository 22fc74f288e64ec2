// Tables of comma separated values, plain or compressed by xz.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::data {

/// A header line, no quotes. Lines are counted from 1, the header's. Memory: a block of 64 KiB and a line, however large the file.
class CsvFile {
 public:
  static constexpr std::uint64_t kMaxUnpackedBytes = std::uint64_t{1} << 30;
  static constexpr std::size_t kMaxLineBytes = 4096;

  /// @param file      unpacked where its name ends in .xz, up to kMaxUnpackedBytes
  /// @param columns   that must be there, in any order; others are left alone
  /// @param optional  that need not be there
  /// @throws std::runtime_error "file:line: reason", as all below; "file: reason" when it cannot be opened
  CsvFile(const std::filesystem::path& file, std::initializer_list<std::string_view> columns, std::initializer_list<std::string_view> optional = {});

  /// @return whether there is another row; its cells are then at hand
  bool Next();

  /// @param column  index into `columns`, then `optional`, as in all below
  bool Has(std::size_t column) const { return place_[column] < num_columns_; }

  /// Precondition for all below: Has(column).
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
  std::function<std::size_t(std::span<std::uint8_t>)> read_;  // as XzFile::Read
  std::vector<std::uint8_t> block_;
  std::size_t block_begin_ = 0;
  std::size_t block_end_ = 0;
  std::string line_;
  std::vector<std::string_view> cells_;
  std::vector<std::string> names_;  // of the columns that were asked for
  std::vector<std::size_t> place_;  // of the wanted columns in a row
  std::size_t num_columns_ = 0;
  std::int64_t line_number_ = 0;
};

}  // namespace lookout::data
