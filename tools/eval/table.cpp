#include "tools/eval/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

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

void Table::PrintCsv(std::ostream& out) const {
  for (const auto& row : rows_) {
    for (std::size_t column = 0; column < row.size(); ++column) out << (column > 0 ? "," : "") << CsvCell(row[column]);
    out << '\n';
  }
}

std::string Number(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string Number(std::int64_t value) { return std::to_string(value); }

}  // namespace lookout::eval
