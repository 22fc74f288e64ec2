// Tables of figures: as aligned text, Markdown and CSV files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "common/io/output_file.hpp"

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

  /// Adds a column with this cell in each row.
  void AddColumn(const std::string& heading, const std::string& cell);

  /// @param columns    indices, in the order of the result
  /// @param is_wanted  of a row, by its first cell
  Table Select(const std::vector<std::size_t>& columns, const std::function<bool(const std::string&)>& is_wanted) const;

  void Print(std::ostream& out) const;

  void PrintCsv(std::ostream& out) const;

  std::string ToMarkdown() const;

 private:
  std::vector<Row> rows_;
};

struct NamedTable {
  std::string name;  // name of the table's file, without ending
  std::string title;
  Table table;
  bool is_printed = true;  // else in a file alone: too long for a screen, or of interest to few
};

/// Prints the tables that are not empty and are to be printed, each under its title.
void PrintTables(const std::vector<NamedTable>& tables, std::ostream& out);

/// CSV files of tables that are measured for a long time: opened before all work, so that a fault shows at once.
class TableFiles {
 public:
  /// Makes the folder, and opens NAME.csv for each table.
  ///
  /// @param folder  empty: nothing is written
  /// @param tables  may lack their rows
  /// @throws std::runtime_error when a file is there and not forced, or cannot be written
  TableFiles(const std::filesystem::path& folder, const std::vector<NamedTable>& tables, bool is_forced);

  /// Writes the files. @param tables  the tables of the constructor, in their order, with rows.
  void Commit(const std::vector<NamedTable>& tables);

 private:
  std::vector<std::unique_ptr<io::OutputFile>> files_;
};

/// A line of a CSV file: as RFC 4180 has it, but for its end, which is that of Unix. Texts are as CsvText; numbers stay as they are.
std::string CsvRow(const Table::Row& cells);

/// @return fixed decimals; "-" when the value is not a finite number
std::string Number(double value, int decimals);
std::string Number(std::int64_t value);
/// "never" where the value is infinite.
std::string NumberOrNever(double value, int decimals);
/// A share in per cent.
std::string Percent(double share, int decimals = 1);
/// NaN of nothing.
double ShareOf(std::int64_t part, std::int64_t all);

}  // namespace lookout::eval
