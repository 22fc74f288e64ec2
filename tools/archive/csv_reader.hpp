// Rows of a CSV file, as lookout-export writes them (RFC 4180).
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::archive {

class CsvReader {
 public:
  using Row = std::vector<std::string>;

  /// Reads the header. @throws std::runtime_error when the file cannot be read
  explicit CsvReader(const std::filesystem::path& file);

  const Row& header() const { return header_; }

  /// @return the place of a column; nullopt: there is none
  std::optional<std::size_t> Find(std::string_view column) const;
  /// @throws std::runtime_error where there is none
  std::size_t Place(std::string_view column) const;

  /// @return false at the end. A row has as many cells as the header: missing ones are empty, more are left out
  bool Next(Row& row);

 private:
  bool Read(Row& row);

  std::filesystem::path file_;
  std::vector<char> buffer_;
  std::ifstream in_;
  Row header_;
};

/// @return nullopt where the text is empty or no finite number
std::optional<double> NumberOf(const std::string& text);

}  // namespace lookout::archive
