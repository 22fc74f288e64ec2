// Rows of comma separated values (RFC 4180, lines end in LF). Numbers never depend on the locale; an unknown value is an empty cell.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lookout::exporter {

/// A number with `decimals` (0 to 9) decimals, halves away from zero, never "-0"; empty when it is not finite.
struct Fixed {
  double value;
  int decimals;
};

/// The shortest decimal, without exponent, that reads back as the same number; empty when it is not finite.
struct Shortest {
  double value;
};

/// An angle in degrees with 4 decimals in [0, 360); empty when it is not finite.
struct Direction {
  double angle_rad;
};

/// Empty where it is below 0, which stands for "not known".
struct CountOrEmpty {
  std::int64_t count;
};

struct Empty {};

void AppendCell(std::int64_t value, std::string& text);
void AppendCell(const Fixed& number, std::string& text);
void AppendCell(const Shortest& number, std::string& text);
void AppendCell(const Direction& direction, std::string& text);
inline void AppendCell(const CountOrEmpty& one, std::string& text) {
  if (one.count >= 0) AppendCell(one.count, text);
}
inline void AppendCell(const Empty& /*unused*/, std::string& /*unused*/) {}
/// As CsvText: quoted where it has to be, without control characters, and no formula of a spreadsheet.
void AppendCell(std::string_view value, std::string& text);

/// Appends the first cells of a row: integers, texts and the types above.
template <typename First, typename... Others>
void AppendCells(std::string& text, const First& first, const Others&... others) {
  AppendCell(first, text);
  ((text += ',', AppendCell(others, text)), ...);
}

/// Appends a row.
template <typename... Cells>
void AppendRow(std::string& text, const Cells&... cells) {
  AppendCells(text, cells...);
  text += '\n';
}

}  // namespace lookout::exporter
