// Plain CSV with a header line and without quotes, as lookout-sim writes it.
#pragma once

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::eval {

class CsvReader {
 public:
  /// @throws std::runtime_error when the file cannot be opened or begins with other columns; further columns may follow
  CsvReader(const std::filesystem::path& file, std::string_view columns);

  /// @return where a column stands that need not be there; nullopt when it is not
  std::optional<std::size_t> ColumnOf(std::string_view name) const;

  /// @return whether there is another row; its cells are then at hand
  bool Next();

  std::string_view Text(std::size_t column) const { return cells_[column]; }

  /// @throws std::runtime_error "file:line: reason" when the cell is not a number of this type
  template <typename Number>
  Number Value(std::size_t column) const {
    Number value{};
    const auto cell = cells_[column];
    const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (fault != std::errc() || end != cell.data() + cell.size()) Refuse("not a number: " + std::string(cell));
    return value;
  }

 private:
  [[noreturn]] void Refuse(const std::string& reason) const;

  std::filesystem::path file_;
  std::ifstream in_;
  std::string line_;
  std::vector<std::string_view> cells_;
  std::string header_;
  std::size_t num_columns_ = 0;  // of the header
  int line_number_ = 0;
};

}  // namespace lookout::eval
