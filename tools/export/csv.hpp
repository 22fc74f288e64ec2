// Rows of comma separated values (RFC 4180, lines end in LF). Numbers never depend on the locale; what is unknown is an empty cell.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lookout::exporter {

class CsvWriter {
 public:
  /// @param text  rows are appended here; must outlive the writer
  explicit CsvWriter(std::string& text) : text_(text) {}

  void Integer(std::int64_t value);

  /// A number with `decimals` (0 to 9) decimals, halves away from zero, never "-0"; empty when it is not finite.
  void Fixed(double value, int decimals);

  /// The shortest decimal, without exponent, that reads back as the same number; empty when it is not finite.
  void Shortest(double value);

  /// An angle in degrees with 4 decimals in [0, 360); empty when it is not finite.
  void Direction(double angle_rad);

  /// As CsvText: quoted where it has to be, without control characters, and no formula of a spreadsheet.
  void Text(std::string_view value);

  void Empty() { Separate(); }

  void EndRow() {
    text_ += '\n';
    is_first_ = true;
  }

 private:
  void Separate() {
    if (!is_first_) text_ += ',';
    is_first_ = false;
  }

  std::string& text_;
  bool is_first_ = true;
};

}  // namespace lookout::exporter
