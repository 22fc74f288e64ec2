// Aligned text.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace lookout::eval {

/// Columns are as wide as their widest cell; those that hold numbers only stand to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}

  /// Precondition: as many cells as the header has.
  void Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  bool empty() const { return rows_.size() == 1; }
  const std::vector<std::vector<std::string>>& rows() const { return rows_; }  // the first is the header

  void Print(std::ostream& out) const;

  /// As RFC 4180 has it, but for line ends of Unix.
  void PrintCsv(std::ostream& out) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// @return fixed decimals; "-" when the value is not a number
std::string Number(double value, int decimals);
std::string Number(std::int64_t value);

}  // namespace lookout::eval
