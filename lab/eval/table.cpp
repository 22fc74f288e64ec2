#include "lab/eval/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/core/printable.hpp"

namespace lookout::eval {
namespace {

bool IsNumber(const std::string& cell) { return cell.find_first_not_of("0123456789+-.%") == std::string::npos; }

std::string CsvCell(const std::string& cell) { return IsNumber(cell) ? cell : CsvText(cell); }

}  // namespace

void Table::Print(std::ostream& out) const {
  for (std::size_t line = 0; line < rows_.size(); ++line) {
    std::string text;
    for (std::size_t column = 0; column < rows_[line].size(); ++column) {
      std::size_t width = 0;
      bool is_number = true;
      for (std::size_t other = 0; other < rows_.size(); ++other) {
        width = std::max(width, rows_[other][column].size());
        if (other > 0 && !IsNumber(rows_[other][column])) is_number = false;
      }
      const std::string cell = PrintableLines(rows_[line][column]);
      const std::string padding(width - cell.size(), ' ');
      if (column > 0) text += "  ";
      text += is_number ? padding + cell : cell + padding;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  }
}

void Table::AddColumn(const std::string& heading, const std::string& cell) {
  for (auto& row : rows_) row.push_back(&row == &rows_.front() ? heading : cell);
}

Table Table::Select(const std::vector<std::size_t>& columns, const std::function<bool(const std::string&)>& is_wanted) const {
  const auto cells_of = [&columns](const Row& row) {
    Row cells;
    for (const auto column : columns) cells.push_back(row[column]);
    return cells;
  };
  Table result(cells_of(header()));
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    if (is_wanted(rows_[i].front())) result.Add(cells_of(rows_[i]));
  }
  return result;
}

void Table::PrintCsv(std::ostream& out) const {
  for (const auto& row : rows_) out << CsvRow(row);
}

std::string Table::ToMarkdown() const {
  std::string text;
  for (const auto& row : rows_) {
    text += '|';
    for (const auto& cell : row) {
      text += ' ';
      for (const char letter : PrintableLines(cell)) text += letter == '|' ? std::string("\\|") : std::string(1, letter);
      text += " |";
    }
    text += '\n';
    if (&row != &header()) continue;
    text += '|';
    for (std::size_t i = 0; i < row.size(); ++i) text += "---|";
    text += '\n';
  }
  return text;
}

std::string Number(double value, int decimals) { return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-"; }

std::string Number(std::int64_t value) { return std::to_string(value); }

std::string NumberOrNever(double value, int decimals) { return std::isinf(value) ? "never" : Number(value, decimals); }

std::string Percent(double share, int decimals) { return Number(100.0 * share, decimals); }

double ShareOf(std::int64_t part, std::int64_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : std::numeric_limits<double>::quiet_NaN();
}

std::string CsvRow(const Table::Row& cells) {
  std::string line;
  for (const auto& cell : cells) line += (&cell == &cells.front() ? "" : ",") + CsvCell(cell);
  return line + '\n';
}

void PrintTables(const std::vector<NamedTable>& tables, std::ostream& out) {
  for (const auto& [name, title, table, is_printed] : tables) {
    if (table.empty() || !is_printed) continue;
    out << title << '\n';
    table.Print(out);
    out << '\n';
  }
}

TableFiles::TableFiles(const std::filesystem::path& folder, const std::vector<NamedTable>& tables, bool is_forced) {
  if (folder.empty()) return;
  std::filesystem::create_directories(folder);
  files_.reserve(tables.size());
  for (const auto& table : tables) {
    files_.push_back(std::make_unique<io::OutputFile>(folder / (table.name + ".csv"), io::OutputOptions{.force = is_forced}));
  }
}

void TableFiles::Commit(const std::vector<NamedTable>& tables) {
  for (std::size_t i = 0; i < files_.size(); ++i) {
    tables.at(i).table.PrintCsv(files_[i]->stream());
    files_[i]->Commit();
  }
}

}  // namespace lookout::eval
