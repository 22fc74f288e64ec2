// Aligned text.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace lookout::eval {

/// Columns are as wide as their widest cell; those that hold numbers only stand to the right.
class Table {
 public:
  using Row = std::vector<std::string>;

  explicit Table(Row header) : rows_{std::move(header)} {}

  /// Precondition: as many cells as the header has.
  void Add(Row row) { rows_.push_back(std::move(row)); }
  bool empty() const { return rows_.size() == 1; }
  const Row& header() const { return rows_.front(); }
  const std::vector<Row>& rows() const { return rows_; }  // the first is the header

  /// The same cell in each row.
  void AddColumn(const std::string& heading, const std::string& cell);

  /// @param columns    indices, in the order of the result
  /// @param is_wanted  of a row, by its first cell
  Table Select(const std::vector<std::size_t>& columns, const std::function<bool(const std::string&)>& is_wanted) const;

  void Print(std::ostream& out) const;

  /// As RFC 4180 has it, but for line ends of Unix.
  void PrintCsv(std::ostream& out) const;

  std::string ToMarkdown() const;

 private:
  std::vector<Row> rows_;
};

/// @return fixed decimals; "-" when the value is not a number
std::string Number(double value, int decimals);
std::string Number(std::int64_t value);

}  // namespace lookout::eval
